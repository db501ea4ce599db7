
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 1

// glsl/common/no_hit.glsl
// glsl/common/ball.glsl
// glsl/common/listener.glsl
// the scene
// Returns the distance from p along d to the first object hit, and its number. The wave that leaves
// a convex surface (last) cannot hit it again. Without a hit before limit the distance is limit,
// and the number is meaningless; if a step limit left the first hit undecided, the distance is
// GIVEN_UP.
float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {
    float nearest = min(hitListener(p, d), limit);
    object = 0.0;
    return nearest;
}

// glsl/common/march_fields.glsl
// names of my.glsl, field 0
#define R user0_R
#define field user0_field

// my.glsl
const float R = 1.0;
float field(vec3 p) { return length(p) - R; }

// end of my.glsl, field 0
#undef R
#undef field

// glsl/shape/cuboid.glsl
// glsl/user/value.glsl, field 0
// the surfaces
// surface 1 (Field)
float field1(vec3 p) {
    float d1 = sdUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return d1;
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
    // surface 1 (Field)
    candidate = field1(p - surfaceValue0.xyz);
    if (candidate < nearest) { nearest = candidate; object = 1.0; }
    return nearest;
}

// glsl/common/march_fields.glsl
// glsl/common/rounding.glsl
// glsl/common/march_fields.glsl
// gradient of my.glsl, field 0
struct dual0_vec3 {
    vec3 v;
    vec3 x;
    vec3 y;
    vec3 z;
};

struct dual0_float {
    float v;
    float x;
    float y;
    float z;
};

dual0_float dual0_length(dual0_vec3 a) {
    vec3 A = a.v; 
    float V = length(A); vec3 N = V > 0.0 ? A / V : vec3(0.48, -0.64, 0.6);
    return dual0_float(V, dot(N, a.x), dot(N, a.y), dot(N, a.z));
}

dual0_float dual0_subtract(dual0_float a, float b) {
    float A = a.v; float B = b; 
    float V = A - B; 
    return dual0_float(V, a.x, a.y, a.z);
}

dual0_float dual0_0field(dual0_vec3 p) {
    return dual0_subtract(dual0_length(p), user0_R);
}

float dual0_field(vec3 p, out vec3 gradient) {
    dual0_float value = dual0_0field(dual0_vec3(p, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)));
    gradient = vec3(value.x, value.y, value.z);
    return value.v;
}

// glsl/shape/cuboid.glsl
// glsl/user/derivative.glsl, field 0
// the surfaces
// surface 1 (Field)
vec4 gradient1(vec3 p) {
    vec4 g1 = gdUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return g1;
}

// the fields
// The gradient of one field, and the error bound of its value.
vec3 fieldGradient(vec3 p, float object, out float errorBound) {
    errorBound = 0.0;
    if (object == 1.0) { errorBound = surfaceValue0.w; return gradient1(p - surfaceValue0.xyz).xyz; } // surface 1 (Field)
    return vec3(0.0);
}

// glsl/common/march_fields.glsl
// the fields
// The fields have no bound along lines.
float fieldsFree(vec3 p, vec3 d, float last, float errorBound) { return 0.0; }

// glsl/common/march_fields.glsl
// glsl/common/onto_field.glsl
// glsl/common/rounding.glsl
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
    // surface 1 (Field)
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
}

// glsl/iterate.frag
