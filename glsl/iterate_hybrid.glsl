// One iteration of profile `hybrid`: in closed form where a surface has one.
//
// The ray is intersected with every surface that has a closed form, and the nearest hit wins. These
// surfaces need no march, and so no minimum distance, no start offset, and no step limit except for
// traversals of infinite repetitions (operator/repeat.glsl). Fields without a closed form are marched, at most
// to the nearest of those hits.

uniform float uMaxDistance;   // a wave counts as dead beyond this, metres; far below NO_HIT

float maxDistance = 0.0;

void copySettings() {
    maxDistance = uMaxDistance;
}

bool finished(float status) {
    return status < 0.1;
}

void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    float t = closestHit(origin.xyz, direction.xyz, origin.w, maxDistance, object);
    bool limitReached = t < 0.0;
#if MARCHES_FIELDS
    float fieldMet;
    float marched = limitReached ? -1.0
        : marchFields(origin.xyz, direction.xyz, origin.w, t, fieldMet, limitReached);
    if (marched >= 0.0) {
        t = marched;
        object = fieldMet;
    }
#endif
    bool met = !limitReached && t < maxDistance;
    bool reflects = met && object != STATUS_LISTENER;
    // All waves execute the same code, whatever their fate: waves that run in lockstep wait for each
    // other at every branch.
    vec3 p = origin.xyz;
    vec3 d = direction.xyz;
    reflectWave(object, t, p, d);
    vec3 end = origin.xyz + (met ? t : 0.0) * direction.xyz;
    origin.xyz = reflects ? p : end;
    origin.w = met ? object : STATUS_DEAD;
    direction.xyz = reflects ? d : direction.xyz;
    direction.w = countPass(direction.w, met && t == 0.0, limitReached);
}
