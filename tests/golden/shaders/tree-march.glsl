
// glsl/wave.glsl
// glsl/counters.glsl
// options
#define MARCHES_FIELDS 1

// option of meshes
#define MEETS_MESHES 0

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
// glsl/common/safe_inverse.glsl
// glsl/shape/cuboid.glsl
// the surfaces
// surface 1 (SmoothUnion)
vec2 chord1_bounds = vec2(0.0);
void findChords1(vec3 p, vec3 d, float errorBound) {
    vec2 c1 = chordBox(p - vec3(0.625, 0.0, 0.0), d, vec3(1.4375, 1.0625, 1.0625) + errorBound);
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
// glsl/shape/cuboid.glsl
// glsl/common/on_line.glsl
// glsl/shape/sphere.glsl
// glsl/common/on_line.glsl
// glsl/shape/sphere.glsl
// glsl/operator/smooth_union.glsl
// the surfaces
// surface 1 (SmoothUnion)
OnLine onLine1(vec3 p, vec3 d) {
    vec4 g1 = gdBox(p, vec3(0.75, 0.75, 0.75));
    OnLine g2 = onLine(g1, d, vec3(0.0));
    vec3 p3 = p - vec3(1.0, 0.0, 0.0);
    vec4 g4 = gdSphere(p3, 1.0);
    OnLine g5 = onLine(g4, d, bendSphere(g4, p3, 1.0));
    OnLine g6 = onLineSmoothUnion(g2, g5, 0.25);
    return g6;
}

// glsl/common/on_line.glsl
// glsl/common/bound.glsl
// glsl/common/on_line.glsl
// glsl/common/ahead.glsl
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

// glsl/common/ahead.glsl
// the fields
// Returns what is ahead of p, which is t metres along the line, in the direction d; the rounding error of p is
// errorBound. A convex field that the wave leaves (last) cannot be hit.
Ahead fieldsAhead(float t, vec3 p, vec3 d, float last, float errorBound) {
    Ahead ahead = nothingAhead();
    // surface 1 (SmoothUnion)
    {
        OnLine field = onLine1(p - surfaceValue0.xyz, d);
        float free = freeOf(field, free1(p - surfaceValue0.xyz, d, max(errorBound, surfaceValue0.w)));
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
// glsl/operator/smooth_union.glsl
// the surfaces
// surface 1 (SmoothUnion)
vec4 gradient1(vec3 p) {
    vec4 g1 = gdBox(p, vec3(0.75, 0.75, 0.75));
    vec3 p2 = p - vec3(1.0, 0.0, 0.0);
    vec4 g3 = gdSphere(p2, 1.0);
    vec4 g4 = opSmoothUnion(g1, g3, 0.25);
    return g4;
}

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
    vec3 metNormal = vec3(0.0);
    bool isMirrored = false;
    // surface 1 (SmoothUnion)
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
