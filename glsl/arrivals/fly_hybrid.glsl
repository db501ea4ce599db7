// The flight of a wave to the next surface past a transparent listener: profile `hybrid`
// (iterate_hybrid.glsl has the theory).

// How far the wave at p flies along d to the next surface, and which that is; at least maxDistance
// where there is none, and -1 where a step limit left open what comes first.
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
