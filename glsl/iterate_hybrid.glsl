// One iteration in closed form where there is one: profile `hybrid`.
//
// The intersection of the wave's line with every surface that has a closed form is solved for; the nearest
// wins. These surfaces need no march, so they have neither a minimum distance nor a start offset, and no
// step limit except for traversals of copies without end (operator/repeat.glsl). Fields without a closed
// form are marched, no further than to the nearest of those hits.

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
    // Waves of every fate execute the same code, each with its own values: waves that are drawn together
    // wait for each other at every branch.
    vec3 p = origin.xyz;
    vec3 d = direction.xyz;
    reflectWave(object, t, p, d);
    vec3 end = origin.xyz + (met ? t : 0.0) * direction.xyz;
    origin.xyz = reflects ? p : end;
    origin.w = met ? object : STATUS_DEAD;
    direction.xyz = reflects ? d : direction.xyz;
    direction.w = countPass(direction.w, met && t == 0.0, limitReached);
}
