// One iteration of profile `march`: accurate sphere tracing.
//
// Theory. The gradient of the nearest surface gives a Newton step along the ray, distance / -(direction .
// gradient); beyond REACH the step is the distance itself (Hart 1996). The distance to a convex solid is
// convex along a line, so a Newton step never overshoots; the step is also limited by the distance to
// every other object, so no object is jumped over. A convex surface that the wave moves away from cannot
// be hit and is skipped (directedDistance): where several faces lie in one plane, none of them slows down
// a wave that leaves one of them. The wave has reached the surface when its distance is within rounding,
// so hits are accurate, without a wide shell around the surface.
//
// Departures from the thesis: no start offset (the status names the surface that the wave left, which it
// cannot hit next); the stored point lies on the surface; the normal is that of the surface hit; dead
// waves stop; directions are kept at length 1.

uniform float uMaxDistance;     // a wave counts as dead beyond this, metres
uniform int uStepLimit;         // maximum number of evaluations in one march

float maxDistance = 0.0;
int stepLimit = 0;

void copySettings() {
    maxDistance = uMaxDistance;
    stepLimit = uStepLimit;
}

bool finished(float status) {
    return status < 0.1;
}

const float REACH = 1e8;     // metres; no surface is ahead beyond this distance, and steps are not Newton's
const float GLANCE = 16.0;   // roundings along the ray beyond which a projection is inexact

// Returns the distance along the ray to the first hit, or -1.
float traceWave(vec3 origin, vec3 direction, float last, out float object, out bool limitReached) {
    float t = 0.0;
    bool refined = false;
    float coarseness = ROUNDING * largest(origin);
    limitReached = false;
    for (int i = 0; i < stepLimit; ++i) {
        vec3 p = origin + t * direction;
        float second;
        float nearest = directedDistance(p, direction, last, object, second);
        COUNT_EVALUATIONS(1.0);
        if (nearest < REACH) {
            if (object == STATUS_LISTENER && nearest <= 0.0) {
                return t;
            }
            float errorBound;
            float closing = -dot(direction, directedGradient(p, direction, object, errorBound));
            // The point has the rounding error of the largest number that it was computed from.
            float rounding = roundingAt(p, max(errorBound, coarseness));
            // A wave cannot go back beyond its start: a solid that contains the start is hit at once.
            bool within = nearest <= rounding && (nearest >= -rounding || t <= 0.0);
            if (closing > 0.0 && within) {
                // At a grazing angle a rounding of the distance is a long way along the ray: one more full
                // Newton step is then taken, unless another object is as near.
                if (refined || nearest <= GLANCE * closing * rounding || second <= rounding) {
                    return t;
                }
                refined = nearest <= second * closing;
            }
            // If the nearest surface does not get nearer along the ray, only the other objects can be hit.
            float step = closing > 0.0 ? min(nearest / closing, second) : second;
            // The march always advances, whatever the rounding.
            t = max(t + step, closing > 0.0 && nearest < 0.0 ? 0.0 : t + 0.5 * rounding);
        } else {
            // `second` is less than `nearest` only at the end of the cell, which a step must not
            // leave.
            t += min(nearest, second);
        }
        if (!(t < maxDistance)) {
            return -1.0;
        }
    }
    limitReached = true;
    return -1.0;
}

void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    bool limitReached;
    float t = traceWave(origin.xyz, direction.xyz, origin.w, object, limitReached);
#if MARCHES_FIELDS
    // If the march of the basic shapes reached its step limit, a field's hit may not be the first.
    float fieldMet;
    bool fieldLimitReached = false;
    float limit = t < 0.0 ? maxDistance : t;
    float marched = limitReached ? -1.0
        : marchFields(origin.xyz, direction.xyz, origin.w, limit, fieldMet, fieldLimitReached);
    limitReached = limitReached || fieldLimitReached;
    if (marched >= 0.0) {
        t = marched;
        object = fieldMet;
    }
    t = limitReached ? -1.0 : t;
#endif
#if MEETS_MESHES
    float meshMet;
    float before = t < 0.0 ? maxDistance : t;
    float met = closestMesh(origin.xyz, direction.xyz, before, meshMet);
    if (!limitReached && met < before) {
        t = met;
        object = meshMet;
    }
#endif
    float counters = countPass(direction.w, t == 0.0, limitReached);
    if (t < 0.0) {
        origin = vec4(origin.xyz, STATUS_DEAD);
        direction.w = counters;
        return;
    }
    vec3 hit = origin.xyz + t * direction.xyz;
    if (object == STATUS_LISTENER) {
        origin = vec4(hit, STATUS_LISTENER);
        direction.w = counters;
        return;
    }
    vec3 projected = origin.xyz;
    vec3 mirrored = direction.xyz;
    reflectWave(object, t, projected, mirrored);
    origin = vec4(projected, object);
    direction = vec4(mirrored, counters);
}
