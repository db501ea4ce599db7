// glsl/wave.glsl
// glsl/counters.glsl
// options
#define EXACT_NORMALS 1
#define LANDING 1
#define MARCHES_FIELDS 0

// glsl/common/listener.glsl
// glsl/shape/sphere.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];

// the scene
// Distance to the nearest object that a wave at p along d can meet, its number, and
// the distance to the second nearest. What the wave leaves (last) is out of its way
// when it is convex, and so is all that it recedes from; of a room only the walls
// ahead count.
float directedDistance(vec3 p, vec3 d, float last, out float object, out float second) {
    float nearest = sdListenerDirected(p, d);
    object = 0.0;
    second = 1e30;
    float candidate;
    // surface 1 (Sphere)
    candidate = last == 1.0 ? 1e30 : sdSphereDirected(p - uSurfaces[0].xyz, d, uSurfaces[0].w);
    if (candidate < nearest) { second = nearest; nearest = candidate; object = 1.0; }
    else { second = min(second, candidate); }
    return nearest;
}

// glsl/common/rounding.glsl
// glsl/shape/sphere.glsl
// the scene
// The gradient of the distance to one object, and what rounding may do to it.
vec3 directedGradient(vec3 p, vec3 d, float object, out float errorBound) {
    if (object == 1.0) { errorBound = roundErrorBound(uSurfaces[0]); return gradientSphere(p - uSurfaces[0].xyz); } // surface 1 (Sphere)
    errorBound = roundErrorBound(uListener);
    return normalize(p - uListener.xyz);
}

// glsl/common/rounding.glsl
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
// glsl/iterate_march.glsl
// glsl/iterate.frag
