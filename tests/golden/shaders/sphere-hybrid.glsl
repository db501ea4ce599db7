// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 0

// glsl/common/listener.glsl
// glsl/common/no_hit.glsl
// glsl/common/ball.glsl
// glsl/common/listener.glsl
// glsl/shape/sphere.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];

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
    candidate = last == 1.0 ? NO_HIT : hitSphere(p - uSurfaces[0].xyz, d, uSurfaces[0].w);
    if (candidate < nearest) { nearest = candidate; object = 1.0; }
    return nearest;
}

// glsl/shape/sphere.glsl
// the scene
// Puts p, met along d, onto the object met; the normal there.
void project(float object, vec3 d, inout vec3 p, out vec3 normal) {
    vec3 q;
    normal = -d;
    if (object == 1.0) { // surface 1 (Sphere)
        q = p - uSurfaces[0].xyz;
        projectSphere(q, uSurfaces[0].w, normal);
        p = q + uSurfaces[0].xyz;
        normal = normal;
        return;
    }
}

// glsl/common/mirror.glsl
// glsl/iterate_hybrid.glsl
// glsl/iterate.frag
