// The picture of the listener's view: the eye, the lights, and the normal of a surface.

uniform vec3 uRight;      // unit vector out of the right ear
uniform vec3 uUp;         // unit vector out of the top of the head
uniform vec3 uForward;    // unit vector of the gaze
uniform vec4 uSource;     // centre in world metres, radius of the ball drawn
uniform vec2 uSize;       // of the picture in pixels
uniform float uPixel;     // size of a pixel one metre ahead, metres

const vec3 SUN = vec3(-0.48, 0.62, 0.62);
const vec3 SUN_LIGHT = vec3(1.0, 0.93, 0.80);
const vec3 SOURCE_LIGHT = vec3(1.0, 0.72, 0.38);

// The surface normal, by differences over the corners of a tetrahedron.
vec3 viewNormal(vec3 p, float e) {
    const vec2 k = vec2(1.0, -1.0);
    float object;
    return normalize(
        k.xyy * surfaceDistance(p + e * k.xyy, object) +
        k.yyx * surfaceDistance(p + e * k.yyx, object) +
        k.yxy * surfaceDistance(p + e * k.yxy, object) +
        k.xxx * surfaceDistance(p + e * k.xxx, object));
}
