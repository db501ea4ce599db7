// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 1

// glsl/rounding.glsl
// glsl/hit/none.glsl
// glsl/hit/ball.glsl
// glsl/distance/box.glsl
// glsl/gradient/box.glsl
// names of my.glsl, field 0
#define R user0_R
#define field user0_field

// my.glsl
const float R = 1.0;
float field(vec3 p) { return length(p) - R; }

// end of my.glsl, field 0
#undef R
#undef field

// use of my.glsl, field 0
// The user's field 0, cut off at its box, and never evaluated beyond.
float sdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float inside = user0_field(clamp(p, -halfSize, halfSize)) * inverseLipschitz;
    return max(inside, sdBox(p, halfSize));
}

// Its gradient by differences over a step that follows from the place, whatever the box.
vec3 differencesOfUser0(vec3 p, float h, vec3 halfSize, float inverseLipschitz) {
    vec2 e = vec2(h, 0.0);
    return vec3(
        sdUser0(p + e.xyy, halfSize, inverseLipschitz) - sdUser0(p - e.xyy, halfSize, inverseLipschitz),
        sdUser0(p + e.yxy, halfSize, inverseLipschitz) - sdUser0(p - e.yxy, halfSize, inverseLipschitz),
        sdUser0(p + e.yyx, halfSize, inverseLipschitz) - sdUser0(p - e.yyx, halfSize, inverseLipschitz)) / (2.0 * h);
}

// The power of 2 next to the largest coordinate: what the text's own rounding goes by.
float scaleOfUser0(vec3 p, vec3 halfSize) {
    return exp2(floor(0.5 + log2(max(largest(p), 9.765625e-4 * largest(halfSize)))));
}

// For a march: right next to edges, and to some 1e-4.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    float h = 9.765625e-4 * scaleOfUser0(p, halfSize);
    return vec4(differencesOfUser0(p, h, halfSize, inverseLipschitz), value);
}

// For a normal: differences of sixth order over wide steps, whose rounding is some
// 1e-6, where the surface is smooth so far that near ones tell the same.
vec4 gnUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    vec4 near = gdUser0(p, halfSize, inverseLipschitz);
    float h = 0.0625 * scaleOfUser0(p, halfSize);
    // Nothing is known beyond the box.
    h = max(min(h, -sdBox(p, halfSize) / 3.0), 0.03125 * h);
    vec3 wide = 1.5 * differencesOfUser0(p, h, halfSize, inverseLipschitz)
        - 0.6 * differencesOfUser0(p, 2.0 * h, halfSize, inverseLipschitz)
        + 0.1 * differencesOfUser0(p, 3.0 * h, halfSize, inverseLipschitz);
    return length(wide - near.xyz) < 4.8828125e-4 ? vec4(wide, near.w) : near;
}

// glsl/land/field.glsl
// glsl/distance/listener.glsl
// glsl/hit/listener.glsl
// the surfaces
uniform vec4 uSurfaces[1];

// surface 1 (Field)
float field1(vec3 p) {
    float d1 = sdUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return d1;
}

// surface 1 (Field)
vec4 gradient1(vec3 p) {
    vec4 g1 = gdUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return g1;
}

// surface 1 (Field)
vec4 normal1(vec3 p) {
    vec4 g1 = gnUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return g1;
}


// the scene
// How far from p along d the next object is, and its number. A convex surface is
// not met by the wave that leaves it (last). Where nothing is met the distance is
// NO_HIT and the number means nothing.
float nearestHit(vec3 p, vec3 d, float last, out float object) {
    float nearest = hitListener(p, d);
    object = 0.0;
    return nearest;
}

// Puts p, met along d, onto the object met; the normal there.
void land(float object, vec3 d, inout vec3 p, out vec3 normal) {
    vec3 q;
    normal = -d;
    if (object == 1.0) { // surface 1 (Field)
        q = p - uSurfaces[0].xyz;
        q = ontoField(q, gradient1(q));
        normal = facing(normal1(q).xyz, d);
        p = q + uSurfaces[0].xyz;
        normal = normal;
        return;
    }
}


// the fields
// The least value of the fields that a wave at p along d can meet, and whose it is. It
// holds as far as reach along d. A convex one that the wave leaves is out of its way.
float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach) {
    float nearest = 1e30;
    reach = 1e30;
    object = -1.0;
    float candidate;
    // surface 1 (Field)
    candidate = field1(p - uSurfaces[0].xyz);
    if (candidate < nearest) { nearest = candidate; object = 1.0; }
    return nearest;
}

// Nothing is known of the fields but their values.
float fieldsFree(vec3 p, vec3 d, float last, float slack) { return 0.0; }

// The gradient of one of them, and what rounding may do to its value.
vec3 fieldGradient(vec3 p, float object, out float slack) {
    slack = 0.0;
    if (object == 1.0) { slack = uSurfaces[0].w; return gradient1(p - uSurfaces[0].xyz).xyz; } // surface 1 (Field)
    return vec3(0.0);
}


// glsl/march_fields.glsl
// glsl/mirror.glsl
// glsl/iterate_hybrid.glsl
// glsl/iterate.frag
