// One iteration of accurate sphere tracing: profile `march`.
//
// Theory. Outside a shell about the surfaces (uShell; by default so wide that it contains everything) the
// wave steps by the distance divided by the Lipschitz bound (Hart 1996). Inside it the gradient of the one
// surface met gives a Newton step along the ray, distance / -(direction . gradient). The distance to a
// convex solid is convex along a line, so its tangent never overshoots; the step is also limited by the
// distance to every other object, so no object is jumped over. A convex surface that the wave moves away
// from is never met on this line, and is skipped (directedDistance): where several faces lie in one plane,
// none of them slows down a wave that leaves one of them. The wave has reached the surface when its
// distance is within rounding, so a wide shell does not cost accuracy.
//
// Departures from the thesis: no start offset (the status names the surface that the wave left, which
// cannot be met next); the stored point lies on the surface; the normal is that of the surface met; dead
// waves stop; directions are kept at length 1.

uniform float uShell;           // width of the shell in which Newton's steps are taken, metres
uniform float uMaxDistance;     // a wave counts as dead beyond this, metres
uniform float uLipschitz;       // greatest growth of the distance per metre
uniform float uDistanceFactor;  // the distance is multiplied by this: 1, or a test's distortion
uniform int uStepLimit;         // maximum number of evaluations in one march
uniform float uNormalStep;      // step of difference normals, metres

float shell = 0.0;
float maxDistance = 0.0;
float distanceScale = 0.0;
int stepLimit = 0;

void copySettings() {
    shell = uShell;
    maxDistance = uMaxDistance;
    distanceScale = uDistanceFactor / uLipschitz;
    stepLimit = uStepLimit;
}

bool finished(float status) {
    return status < 0.1;
}

const float GLANCE = 16.0;   // roundings along the ray that make a projection inexact

// Distance that the wave flies along its direction, or -1.
float traceWave(vec3 origin, vec3 direction, float last, out float object, out bool limitReached) {
    float t = 0.0;
    bool refined = false;
    float coarseness = ROUNDING * largest(origin);
    limitReached = false;
    for (int i = 0; i < stepLimit; ++i) {
        vec3 p = origin + t * direction;
        float second;
        float nearest = directedDistance(p, direction, last, object, second) * distanceScale;
        second *= distanceScale;
        COUNT_EVALUATIONS(1.0);
        if (nearest < shell) {
#if PROJECTION
            if (object == STATUS_LISTENER && nearest <= 0.0) {
                return t;
            }
            float errorBound;
            float closing = -dot(direction, directedGradient(p, direction, object, errorBound));
            // The point is as coarse as the largest number it was computed from.
            float rounding = roundingAt(p, max(errorBound, coarseness));
            // A wave cannot go back beyond its start: a solid that contains the start is met at once.
            bool within = nearest <= rounding && (nearest >= -rounding || t <= 0.0);
            if (closing > 0.0 && within) {
                // At a grazing angle a rounding of the distance is a long way along the ray: one more full
                // Newton step is taken there, unless another object is as near.
                if (refined || nearest <= GLANCE * closing * rounding || second <= rounding) {
                    return t;
                }
                refined = nearest <= second * closing;
            }
            // The surface ahead comes nearer, within rounding; otherwise only the other objects can be met.
            float step = closing > 0.0 ? min(nearest / closing, second) : second;
            // The march always advances, whatever the rounding.
            t = max(t + step, closing > 0.0 && nearest < 0.0 ? 0.0 : t + 0.5 * rounding);
#else
            return t;
#endif
        } else {
            // The second nearest is never nearer, but a step must not leave the cell.
            t += min(nearest, second);
        }
        if (!(t < maxDistance)) {
            return -1.0;
        }
    }
    limitReached = true;
    return -1.0;
}

#if !EXACT_NORMALS
// As in the thesis: central differences of the distance to all surfaces; 0 where the normal is
// undefined.
vec3 differenceGradient(vec3 p) {
    vec2 e = vec2(uNormalStep, 0.0);
    float object;
    COUNT_EVALUATIONS(6.0);
    return vec3(
        surfaceDistance(p + e.xyy, object) - surfaceDistance(p - e.xyy, object),
        surfaceDistance(p + e.yxy, object) - surfaceDistance(p - e.yxy, object),
        surfaceDistance(p + e.yyx, object) - surfaceDistance(p - e.yyx, object));
}
#endif

void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    bool limitReached;
    float t = traceWave(origin.xyz, direction.xyz, origin.w, object, limitReached);
#if MARCHES_FIELDS
    // If the march of the basic shapes was given up, the fields cannot be decided either.
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
#if !EXACT_NORMALS
    vec3 gradient = differenceGradient(hit);
    if (!(dot(gradient, gradient) > 0.0)) {
        origin = vec4(hit, STATUS_DEAD);
        direction.w = counters;
        return;
    }
    mirrored = normalize(reflect(direction.xyz, normalize(gradient)));
#endif
#if PROJECTION
    hit = projected;
#endif
    origin = vec4(hit, object);
    direction = vec4(mirrored, counters);
}
