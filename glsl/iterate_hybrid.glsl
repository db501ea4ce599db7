// One iteration in closed form, where there is one: profile `hybrid`.
//
// Every surface that has a closed form is solved for where the line of the wave meets it; the
// nearest wins. There is no march among them, so there is no minimum distance and no start offset,
// and no step limit but for traversals of copies without end (operator/repeat.glsl). Fields without
// a closed form are marched, no further than to the nearest of those hits.

uniform float uMaxDistance;   // a wave counts as dead beyond this, metres; far below NO_HIT

bool finished(float status) {
    return status < 0.1;
}

void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    float t = closestHit(origin.xyz, direction.xyz, origin.w, uMaxDistance, object);
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
    if (limitReached || !(t < uMaxDistance)) {
        direction.w = countPass(direction.w, false, limitReached);
        origin.w = STATUS_DEAD;
        return;
    }
    vec3 hit = origin.xyz + t * direction.xyz;
    direction.w = countPass(direction.w, t == 0.0, false);
    if (object == STATUS_LISTENER) {
        origin = vec4(hit, STATUS_LISTENER);
        return;
    }
    vec3 normal;
    project(object, direction.xyz, hit, normal);
    origin = vec4(hit, object);
    direction.xyz = mirror(direction.xyz, normal);
}
