
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

// glsl/common/rounding.glsl
// glsl/common/safe_inverse.glsl
// glsl/shape/cuboid.glsl
// the surfaces
// surface 1 (Field)
vec2 chord1_bounds = vec2(0.0);
void findChords1(vec3 p, vec3 d, float errorBound) {
    vec2 c1 = chordBox(p - vec3(0.0, 0.0, 0.0), d, vec3(1.5, 1.5, 1.5) + errorBound);
    chord1_bounds = c1 + vec2(-errorBound, errorBound);
}

// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);

// glsl/common/march_fields.glsl
// the fields
// Finds the chords of a line, where the rounding error of p is errorBound.
void findChords(vec3 p, vec3 d, float errorBound) {
    findChords1(p - surfaceValue0.xyz, d, CHORD_MARGIN * max(errorBound, surfaceValue0.w));
}

// glsl/common/rounding.glsl
// glsl/common/bound.glsl
// glsl/common/march_fields.glsl
// the surfaces
float through1(float t) {
    t = t < chord1_bounds.x ? chord1_bounds.x : t;
    t = chord1_bounds.x > chord1_bounds.y || t > chord1_bounds.y ? NO_END : t;
    return t;
}

// glsl/common/march_fields.glsl
// the fields
// The distance that a wave is free after its start, as the chords show: 0 if they show none. The rounding error of the
// start is errorBound.
float freeAtStart(float last, float errorBound) {
    float free = NO_END;
    free = min(free, freeBy(through1(EARLY * max(errorBound, surfaceValue0.w)), EARLY * max(errorBound, surfaceValue0.w)));
    return free;
}

// glsl/common/march_fields.glsl
// glsl/common/on_line.glsl
// glsl/common/ahead.glsl
// glsl/common/on_line.glsl
// names of my.glsl, field 0
#define R user0_R
#define field user0_field

// my.glsl
const float R = 1.0;
float field(vec3 p) { return length(p) - R; }

// end of my.glsl, field 0
#undef R
#undef field

// glsl/user/value.glsl, field 0
// glsl/shape/cuboid.glsl
// glsl/user/value.glsl, field 0
// the surfaces
// surface 1 (Field)
float field1(vec3 p) {
    float d1 = sdUser0(p, vec3(1.5, 1.5, 1.5), 0.5);
    return d1;
}

// glsl/common/bound.glsl
// glsl/common/on_line.glsl
// glsl/common/ahead.glsl
// the fields
// Returns what is ahead of p, which is t metres along the line, in the direction d; the rounding error of p is
// errorBound. A convex field that the wave leaves (last) cannot be hit.
Ahead fieldsAhead(float t, vec3 p, vec3 d, float last, float errorBound) {
    Ahead ahead = nothingAhead();
    // surface 1 (Field)
    {
        OnLine field = valueOnLine(field1(p - surfaceValue0.xyz));
        float free = freeOf(field, 0.0);
        free = through1(t + free) - t;
        addField(ahead, 1.0, field, free, surfaceValue0.w);
    }
    return ahead;
}

// glsl/common/march_fields.glsl
// the march of the fields
// Returns the distance along the ray to the first hit before limit, or -1.
float marchFields(vec3 origin, vec3 d, float last, float limit, out float object, out bool limitReached) {
    const bool isFree = false;   // whether all steps are free, as slope and bend of every field show
    float size = largest(origin);
    findChords(origin, d, ROUNDING * size);
    float start = freeAtStart(last, ROUNDING * size);
    March march = March(0.0, 0.0, start, start);
    bool isHit = false;
    bool isBeyond = start >= limit;
    int stepLimit = isBeyond ? 0 : uFieldSteps;
    object = -1.0;
    float t = 0.0;
    float root = 0.0;
    int i = 0;
    for (; i < stepLimit; ++i) {
        t = march.proven + march.trial;
        vec3 p = origin + t * d;
        float rounding = ROUNDING * max(largest(p), size);
        Ahead ahead = fieldsAhead(t, p, d, last, rounding);
        COUNT_EVALUATIONS(1.0);
        object = ahead.object;
        float value = ahead.nearest.value;
        float touch = PLACE * max(rounding, ahead.errorBound);
        float near = NEAR * touch;
        bool isFirst = t <= 0.0 && i == 0;
        bool isNear = march.free < near;
        bool isProven = isFree || isNear || march.trial <= march.free || value + march.free >= march.trial;
        float slope = isFree ? ahead.nearest.slope : slopeOf(ahead, march, near);
        root = max(-value / min(slope, -FLATTEST), -SHALLOW * touch);
        bool touches = !isFirst && isTouch(value, slope, touch);
        bool isSolid = isProven && value < -touch && !isFirst;
        bool isEnclosed = isSolid && (isFree || march.trial <= touch);
        isHit = isProven && slope < 0.0 && (touches || isEnclosed || isTangentHit(ahead, slope, root));
        float free = min(ahead.free, ahead.others);
        isBeyond = isProven && t + (isHit ? 0.0 : min(free, ahead.cell)) >= limit;
        if (isHit || isBeyond) {
            break;
        }
        if (isProven && (isFree || !isSolid)) {
            float way = isFree ? max(min(free, ahead.cell), 0.5 * touch) : stepAhead(ahead, slope, touch);
            march = March(t, max(value, 0.0), max(free, 0.0), way);
        } else {
            march.trial = stepBack(march, value, isSolid);
        }
    }
    t = isHit ? max(t + root, 0.0) : t;
    limitReached = !isHit && !isBeyond;
    return isHit && t < limit ? t : -1.0;
}

// glsl/common/turns_of.glsl
// glsl/common/onto_field.glsl
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
    vec3 metNormal = vec3(0.0);
    bool isMirrored = false;
    // surface 1 (Field)
    if (object == 1.0) {
        p = hit;
        q = p - surfaceValue0.xyz;
        vec3 at = q;
        normal = vec3(0.0);
        int sheets = turnsOf(SHEETS, largest(p));
        for (int sheet = 0; sheet < sheets && normal == vec3(0.0); ++sheet) {
            vec4 gradient = gradient1(at);
            q = sheet == 0 ? ontoField(q, gradient) : q;
            normal = facing(gradient.xyz, along);
            at = (sheet == 0 ? q : at) + APART * roundingAt(p, surfaceValue0.w) * unitOrZero(gradient.xyz);
        }
        p = q + surfaceValue0.xyz;
        normal = normal;
        metNormal = normal;
        isMirrored = true;
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
}

// glsl/iterate.frag
