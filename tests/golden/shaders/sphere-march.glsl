
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 0

// option of meshes
#define MEETS_MESHES 0

// glsl/common/rounding.glsl
// glsl/common/listener.glsl
// glsl/shape/sphere.glsl
// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);

// the scene
// Distance to the nearest object that a wave at p along d can hit, its number, and
// the distance to the second nearest. A convex surface that the wave
// leaves (last) or moves away from cannot be hit; of a room, only the walls ahead
// can be hit.
float directedDistance(vec3 p, vec3 d, float last, out float object, out float second) {
    float nearest = sdListenerDirected(p, d);
    object = 0.0;
    second = 1e30;
    float candidate;
    // surface 1 (Sphere)
    candidate = last == 1.0 ? 1e30 : sdSphereDirected(p - surfaceValue0.xyz, d, surfaceValue0.w);
    if (candidate < nearest) { second = nearest; nearest = candidate; object = 1.0; }
    else { second = min(second, candidate); }
    return nearest;
}

// glsl/common/rounding.glsl
// glsl/shape/sphere.glsl
// the scene
// The gradient of the distance to one object, and the distance's error bound.
vec3 directedGradient(vec3 p, vec3 d, float object, out float errorBound) {
    if (object == 1.0) { errorBound = roundErrorBound(surfaceValue0); return gradientSphere(p - surfaceValue0.xyz); } // surface 1 (Sphere)
    errorBound = roundErrorBound(listener);
    return normalize(p - listener.xyz);
}

// glsl/common/rounding.glsl
// glsl/shape/sphere.glsl
// glsl/common/mirror_direction.glsl
// the scene
// Reflects a wave at the object that it hits t metres ahead: moves p along d onto the surface, and
// mirrors d.
void reflectWave(float object, float t, inout vec3 p, inout vec3 d) {
    vec3 from = p;
    vec3 along = d;
    vec3 hit = p + t * d;
    vec3 q;
    vec3 normal;
    vec3 metNormal = vec3(0.0);
    bool isMirrored = false;
    // surface 1 (Sphere)
    {
        vec4 selected0 = surfaceValue0;
        vec3 onto = hit;
        q = onto - selected0.xyz;
        projectSphere(q, selected0.w, normal);
        onto = q + selected0.xyz;
        normal = normal;
        bool isMet = object == 1.0;
        p = isMet ? onto : p;
        metNormal = isMet ? normal : metNormal;
        isMirrored = isMet || isMirrored;
    }
    d = isMirrored ? mirror(along, metNormal) : d;
}

// glsl/iterate_march.glsl
// glsl/iterations.glsl
// glsl/common/listener.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];

float squaredRadius0 = 0.0;

// Copies for the loops: a driver may load a uniform again at each use.
void copyUniforms() {
    listener = uListener;
    squaredListenerRadius = listener.w * listener.w;
    surfaceValue0 = uSurfaces[0];
    squaredRadius0 = surfaceValue0.w * surfaceValue0.w;
}

// glsl/iterate.frag
