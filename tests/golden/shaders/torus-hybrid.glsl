
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 1

// glsl/common/no_hit.glsl
// glsl/common/ball.glsl
// glsl/common/listener.glsl
// the scene
// How far from p along d the next object is, and its number. A convex surface is
// not met by the wave that leaves it (last). Where nothing is met before limit the
// distance is limit and the number means nothing; it is GIVEN_UP where a step limit
// left open what comes first.
float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {
    float nearest = min(hitListener(p, d), limit);
    object = 0.0;
    return nearest;
}

// glsl/common/march_fields.glsl
// glsl/shape/torus.glsl
// the surfaces
// surface 1 (Torus)
float field1(vec3 p) {
    float d1 = sdTorus(p, 2.0, 0.5);
    return d1;
}

// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);

// the fields
// The least value of the fields that a wave at p along d can meet, and whose it is. It
// holds as far as reach along d; as far as within the same fields are asked. A convex one
// that the wave leaves is out of its way.
float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach, out float within) {
    float nearest = 1e30;
    reach = 1e30;
    within = 1e30;
    object = -1.0;
    float candidate;
    // surface 1 (Torus)
    candidate = field1(p - surfaceValue0.xyz);
    if (candidate < nearest) { nearest = candidate; object = 1.0; }
    return nearest;
}

// glsl/common/march_fields.glsl
// glsl/common/rounding.glsl
// glsl/common/march_fields.glsl
// glsl/shape/torus.glsl
// the surfaces
// surface 1 (Torus)
vec4 gradient1(vec3 p) {
    vec4 g1 = gdTorus(p, 2.0, 0.5);
    return g1;
}

// the fields
// The gradient of one of them, and what rounding may do to its value.
vec3 fieldGradient(vec3 p, float object, out float errorBound) {
    errorBound = 0.0;
    if (object == 1.0) { errorBound = surfaceValue0.w; return gradient1(p - surfaceValue0.xyz).xyz; } // surface 1 (Torus)
    return vec3(0.0);
}

// glsl/common/march_fields.glsl
// glsl/common/bound.glsl
// glsl/shape/torus.glsl
// the surfaces
// surface 1 (Torus)
float free1(vec3 p, vec3 d, float errorBound) {
    vec4 b1 = gdTorus(p, 2.0, 0.5);
    vec4 b2 = orPlain(alongTorus(b1, p, d, 2.0, 0.5), errorBound);
    return freeAlong(b2, errorBound);
}

// the fields
// How far along d from p no field is met for sure, where errorBound is what rounding may do
// to their values.
float fieldsFree(vec3 p, vec3 d, float last, float errorBound) {
    float way = NO_END;
    float candidate;
    // surface 1 (Torus)
    candidate = field1(p - surfaceValue0.xyz);
    if (candidate < way) { way = min(way, max(candidate, free1(p - surfaceValue0.xyz, d, max(errorBound, surfaceValue0.w)))); }
    return way;
}

// glsl/common/march_fields.glsl
// glsl/common/onto_field.glsl
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
    // surface 1 (Torus)
    if (object == 1.0) {
        p = hit;
        q = p - surfaceValue0.xyz;
        q = ontoField(q, gradient1(q));
        normal = facing(gradient1(q).xyz, along);
        p = q + surfaceValue0.xyz;
        normal = normal;
        d = mirror(along, normal);
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
}

// glsl/iterate.frag
