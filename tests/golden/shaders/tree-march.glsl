
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 1

// glsl/common/rounding.glsl
// glsl/common/listener.glsl
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
    return nearest;
}

// glsl/common/rounding.glsl
// the scene
// The gradient of the distance to one object, and the distance's error bound.
vec3 directedGradient(vec3 p, vec3 d, float object, out float errorBound) {
    errorBound = roundErrorBound(listener);
    return normalize(p - listener.xyz);
}

// glsl/common/rounding.glsl
// glsl/common/march_fields.glsl
// glsl/shape/cuboid.glsl
// glsl/shape/sphere.glsl
// glsl/operator/smooth_union.glsl
// the surfaces
// surface 1 (SmoothUnion)
float field1(vec3 p) {
    float d1 = sdBox(p, vec3(0.75, 0.75, 0.75));
    vec3 p2 = p - vec3(1.0, 0.0, 0.0);
    float d3 = sdSphere(p2, 1.0);
    float d4 = opSmoothUnion(d1, d3, 0.25);
    return d4;
}

// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);

// the fields
// The least value of the fields that a wave at p along d can hit, and that field's
// number. The value is valid up to reach along d; the same fields are evaluated up to within.
// A convex field that the wave leaves (last) cannot be hit.
float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach, out float within) {
    float nearest = 1e30;
    reach = 1e30;
    within = 1e30;
    object = -1.0;
    float candidate;
    // surface 1 (SmoothUnion)
    candidate = field1(p - surfaceValue0.xyz);
    if (candidate < nearest) { nearest = candidate; object = 1.0; }
    return nearest;
}

// glsl/common/march_fields.glsl
// glsl/shape/cuboid.glsl
// glsl/shape/sphere.glsl
// the surfaces
// surface 1 (SmoothUnion)
vec4 gradient1(vec3 p) {
    vec4 g1 = gdBox(p, vec3(0.75, 0.75, 0.75));
    vec3 p2 = p - vec3(1.0, 0.0, 0.0);
    vec4 g3 = gdSphere(p2, 1.0);
    vec4 g4 = opSmoothUnion(g1, g3, 0.25);
    return g4;
}

// the fields
// The gradient of one field, and the error bound of its value.
vec3 fieldGradient(vec3 p, float object, out float errorBound) {
    errorBound = 0.0;
    if (object == 1.0) { errorBound = surfaceValue0.w; return gradient1(p - surfaceValue0.xyz).xyz; } // surface 1 (SmoothUnion)
    return vec3(0.0);
}

// glsl/common/march_fields.glsl
// glsl/common/bound.glsl
// glsl/operator/smooth_union.glsl
// the surfaces
// surface 1 (SmoothUnion)
float free1(vec3 p, vec3 d, float errorBound) {
    vec4 b1 = gdBox(p, vec3(0.75, 0.75, 0.75));
    vec4 b2 = orPlain(vec4(1.0 * b1.w, 1.0 * dot(b1.xyz, d), 0.0, NO_END), errorBound);
    vec3 p3 = p - vec3(1.0, 0.0, 0.0);
    vec4 b4 = gdSphere(p3, 1.0);
    vec4 b5 = orPlain(vec4(1.0 * b4.w, 1.0 * dot(b4.xyz, d), 0.0, NO_END), errorBound);
    vec4 b6 = orPlain(blendAlong(b2, b5, 0.25), errorBound);
    return freeAlong(b6, errorBound);
}

// the fields
// Distance along d from p that is certainly free of every field; errorBound is the rounding
// error of their values.
float fieldsFree(vec3 p, vec3 d, float last, float errorBound) {
    float way = NO_END;
    float candidate;
    // surface 1 (SmoothUnion)
    candidate = field1(p - surfaceValue0.xyz);
    if (candidate < way) { way = min(way, max(candidate, free1(p - surfaceValue0.xyz, d, max(errorBound, surfaceValue0.w)))); }
    return way;
}

// glsl/common/march_fields.glsl
// glsl/common/onto_field.glsl
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
    // surface 1 (SmoothUnion)
    if (object == 1.0) {
        p = hit;
        q = p - surfaceValue0.xyz;
        q = ontoField(q, gradient1(q));
        vec3 at = q;
        normal = vec3(0.0);
        for (int sheet = 0; sheet < SHEETS && normal == vec3(0.0); ++sheet) {
            vec3 gradient = gradient1(at).xyz;
            normal = facing(gradient, along);
            at += APART * roundingAt(p, surfaceValue0.w) * unitOrZero(gradient);
        }
        p = q + surfaceValue0.xyz;
        normal = normal;
        d = mirror(along, normal);
    }
}

// glsl/iterate_march.glsl
// glsl/iterations.glsl
// glsl/common/listener.glsl
// the values of the surfaces
uniform vec4 uSurfaces[1];


// Copies for the loops: a driver may load a uniform again at each use.
void copyUniforms() {
    listener = uListener;
    squaredListenerRadius = listener.w * listener.w;
    surfaceValue0 = uSurfaces[0];
}

// glsl/iterate.frag
