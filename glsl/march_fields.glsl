// Sphere tracing of fields: of the surfaces that have no closed form, or whose solid is not
// convex, so that a tangent may overshoot.
//
// Theory. fieldsAhead is never more than the distance (Hart 1996). Where it changes along the
// ray by s a metre, a step of 2 f / (1 - s) is as long as two balls of no surface that touch;
// if they turn out not to touch, the step is taken back to the first one's radius (Keinert et
// al. 2014, "Enhanced sphere tracing"; Balint and Valasek 2018 for the step from the slope). A
// few roundings away from the surface the gradient takes over: Newton's step on the way in, a
// relaxed one on the way out, so that the surface that the wave leaves is only met again when
// the wave comes back to it. A thing thinner than NEAR roundings may be overlooked there.

uniform int uFieldSteps;   // evaluations in one march at the most

const float NEAR = 64.0;      // roundings from the surface within which the gradient is asked
const float RELAXED = 0.95;   // of the step for which the balls would just touch

// How far a wave gets along its direction before limit, or -1.
float marchFields(vec3 origin, vec3 d, float last, float limit, out float object, out bool guardHit) {
    float t = 0.0;
    float radius = 0.0;   // of the ball before, which is free of surfaces
    float taken = 0.0;    // the step from there
    float before = 0.0;   // the value there
    float air = -1.0;     // the last place in the air, once there was one
    float solid = -1.0;   // a place in a solid beyond it
    guardHit = false;
    for (int i = 0; i < uFieldSteps; ++i) {
        vec3 p = origin + t * d;
        float reach;
        float f = fieldsAhead(p, d, last, object, reach);
        COUNT_EVALUATIONS(1.0);
        if (taken > radius && radius + f < taken) {
            t += radius - taken;
            taken = radius;
            continue;
        }
        float slope = taken > 0.0 ? (f - before) / taken : -1.0;
        float rounding = ROUNDING * (largest(p) + largest(origin));
        before = f;
        if (solid < 0.0 ? f >= -rounding : f > 0.0) {
            air = t;
        }
        if (f < NEAR * rounding) {
            float slack;
            float closing = -dot(d, fieldGradient(p, object, slack));
            rounding = max(rounding, slack);
            // It went in on the way here, whatever gradients say (they are coarse at edges):
            // from now on the way is halved.
            solid = f < -4.0 * rounding && air >= 0.0 ? t : solid;
            if (solid >= 0.0) {
                solid = f <= 0.0 ? t : solid;
                if (abs(f) <= rounding || solid - air <= rounding) {
                    return t < limit ? t : -1.0;
                }
                t = 0.5 * (air + solid);
                taken = 0.0;
                radius = 0.0;
                continue;
            }
            if (closing > 0.0) {
                if (abs(f) <= rounding) {
                    return t < limit ? max(t, 0.0) : -1.0;
                }
                radius = max(f / closing, -t);
                taken = radius;
                t += min(taken, reach);
                continue;
            }
            slope = -closing;
            radius = max(abs(f), rounding);
        } else {
            radius = f;
        }
        if (solid >= 0.0) {
            radius = min(radius, 0.5 * (solid - t));
        }
        taken = max(radius, RELAXED * 2.0 * radius / (1.0 - clamp(slope, -1.0, 0.9)));
        // Beyond its cell nothing is known of what the ball before holds: no relaxed step goes there.
        taken = taken < reach && solid < 0.0 ? taken : min(radius, reach);
        t += taken;
        if (t - taken + min(radius, reach) >= limit) {
            return -1.0;
        }
    }
    guardHit = true;
    return -1.0;
}
