// Flight of a wave to the next surface past a transparent listener: profile `hybrid`
// (theory: iterate_hybrid.glsl).

// Returns the distance from p along d to the next surface, and the surface's number in `object`: at
// least maxDistance without a hit, -1 if a step limit left the first hit undecided.
float fly(vec3 p, vec3 d, float last, out float object) {
    float t = closestHit(p, d, last, maxDistance, object);
#if MARCHES_FIELDS
    bool limitReached = t < 0.0;
    float fieldMet;
    float marched = limitReached ? -1.0
        : marchFields(p, d, last, t, fieldMet, limitReached);
    if (marched >= 0.0) {
        t = marched;
        object = fieldMet;
    }
    t = limitReached ? -1.0 : t;
#endif
    return t;
}
