// Flight of a wave to the next surface past a transparent listener: profile `march`
// (theory: iterate_march.glsl).

// Returns the distance from p along d to the next surface, and the surface's number in `object`: at
// least maxDistance without a hit, -1 if a step limit left the first hit undecided.
float fly(vec3 p, vec3 d, float last, out float object) {
    bool limitReached;
    float t = traceWave(p, d, last, object, limitReached);
    t = t < 0.0 ? maxDistance : t;
#if MARCHES_FIELDS
    // If the march of the basic shapes reached its step limit, a field's hit may not be the first.
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
#if MEETS_MESHES
    float meshMet;
    float met = closestMesh(p, d, t, meshMet);
    if (met < t) {
        t = met;
        object = meshMet;
    }
#endif
    return limitReached ? -1.0 : t;
}
