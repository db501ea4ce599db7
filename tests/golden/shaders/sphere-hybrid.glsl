
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
// Returns the distance from p along d to the first object hit, and its number. The wave that leaves
// a convex surface (last) cannot hit it again. Without a hit before limit the distance is limit,
// and the number is meaningless; if a step limit left the first hit undecided, the distance is
// GIVEN_UP.
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

// glsl/iterate_hybrid.glsl
// glsl/iterations.glsl
// glsl/common/listener.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];

// Copies for the loops: a driver may load a uniform again at each use.
void copyUniforms() {
    listener = uListener;
    squaredListenerRadius = listener.w * listener.w;
    surfaceValue0 = uSurfaces[0];
    squaredRadius0 = surfaceValue0.w * surfaceValue0.w;
}

// glsl/iterate.frag
