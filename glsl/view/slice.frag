// A horizontal cut through the scene, seen from above: x to the right, z downwards. Solids are filled in
// their surface's hue and outlined; in the air a faint line at every metre of distance shows the field that
// waves march through.

uniform vec2 uCorner;         // world x and z of the picture's upper left, metres
uniform float uMetres;        // metres in a pixel
uniform float uHeight;        // world y of the cut, metres
uniform float uRows;          // height of the picture in pixels
uniform float uLine;          // thickness of an outline, pixels
uniform float uIsoline;       // metres between two lines of equal distance

layout(location = 0) out vec4 outColour;

float field(vec2 place, out float object) {
    return surfaceDistance(vec3(place.x, uHeight, place.y), object);
}

// Growth of the distance per metre in the plane: at most 1, and less where the nearest surface is the
// floor, the ceiling or slanted.
float slope(vec2 place) {
    vec2 e = vec2(0.5 * uMetres, 0.0);
    float object;
    vec2 difference = vec2(
        field(place + e.xy, object) - field(place - e.xy, object),
        field(place + e.yx, object) - field(place - e.yx, object));
    return length(difference) / uMetres;
}

void main() {
    copyUniforms();
    vec2 pixel = vec2(gl_FragCoord.x, uRows - gl_FragCoord.y);
    vec2 place = uCorner + pixel * uMetres;
    float object;
    float nearest = field(place, object);
    float grows = slope(place);
    float perPixel = max(grows, 0.05) * uMetres;
    float pixels = nearest / perPixel;

    vec3 air = vec3(0.985);
    float line = abs(fract(nearest / uIsoline + 0.5) - 0.5) * uIsoline / perPixel;
    float faint = clamp(1.0 - line, 0.0, 1.0) * smoothstep(0.3, 0.7, grows);
    air = mix(air, vec3(0.60, 0.66, 0.70), 0.7 * faint);

    vec3 solid = surfaceColour(object, 0.85, 0.05);
    vec3 colour = mix(air, solid, clamp(0.5 - pixels, 0.0, 1.0));
    // The outline lies on the solid's side.
    float outline = clamp(0.5 - pixels, 0.0, 1.0) * clamp(0.5 + pixels + uLine, 0.0, 1.0);
    colour = mix(colour, surfaceColour(object, 0.36, 0.04), outline);
    outColour = vec4(toScreen(colour), 1.0);
}
