// The flight of a wave to the next surface past a transparent listener: profile `march`
// (iterate_march.glsl has the theory).

// How far the wave at p flies along d to the next surface, and which that is; at least maxDistance
// where there is none, and -1 where a step limit left open what comes first.
float fly(vec3 p, vec3 d, float last, out float object) {
    bool limitReached;
    float t = traceWave(p, d, last, object, limitReached);
    t = t < 0.0 ? maxDistance : t;
#if MARCHES_FIELDS
    // Where the basic shapes gave up, nothing is known of what lies ahead.
    float fieldMet;
    bool fieldLimitReached = false;
    float marched = limitReached ? -1.0
        : marchFields(p, d, last, t, fieldMet, fieldLimitReached);
    limitReached = limitReached || fieldLimitReached;
    if (marched >= 0.0) {
        t = marched;
        object = fieldMet;
    }
#endif
    return limitReached ? -1.0 : t;
}
