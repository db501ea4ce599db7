
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 0

// glsl/common/no_hit.glsl
// glsl/common/ball.glsl
// glsl/common/listener.glsl
// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);
float squaredRadius0 = 0.0;

// the scene
// How far from p along d the next object is, and its number. A convex surface is
// not met by the wave that leaves it (last). Where nothing is met before limit the
// distance is limit and the number means nothing; it is GIVEN_UP where a step limit
// left open what comes first.
float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {
    float nearest = min(hitListener(p, d), limit);
    object = 0.0;
    float candidate;
    // surface 1 (Sphere)
    candidate = hitBall(p - surfaceValue0.xyz, d, squaredRadius0);
    candidate = last == 1.0 ? NO_HIT : candidate;
    object = candidate < nearest ? 1.0 : object;
    nearest = min(candidate, nearest);
    return nearest;
}

// glsl/shape/sphere.glsl
// glsl/common/mirror_direction.glsl
// the scene
// Reflects a wave at the object that it meets t ahead: p, from where it flies along d,
// becomes the point on the surface, and d is mirrored.
void reflectWave(float object, float t, inout vec3 p, inout vec3 d) {
    vec3 from = p;
    vec3 along = d;
    vec3 hit = p + t * d;
    vec3 q;
    vec3 normal;
    // surface 1 (Sphere)
    {
        vec4 selected0 = surfaceValue0;
        vec3 onto = hit;
        q = onto - selected0.xyz;
        projectSphere(q, selected0.w, normal);
        onto = q + selected0.xyz;
        normal = normal;
        vec3 mirrored = mirror(along, normal);
        bool isMet = object == 1.0;
        p = isMet ? onto : p;
        d = isMet ? mirrored : d;
    }
}

// glsl/iterate_hybrid.glsl
// glsl/iterations.glsl
// glsl/common/listener.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];

// Copies for the loops: a uniform may be loaded again at each use.
void copyUniforms() {
    listener = uListener;
    squaredListenerRadius = listener.w * listener.w;
    surfaceValue0 = uSurfaces[0];
    squaredRadius0 = surfaceValue0.w * surfaceValue0.w;
}

// glsl/iterate.frag
