// Sphere tracing of fields: surfaces without a closed-form intersection, or with a solid that is
// not convex, where a Newton step may overshoot.
//
// Theory. fieldsAhead never exceeds the distance (Hart 1996). Where it changes along the ray by s per
// metre, a step of 2 f / (1 - s) ends where the empty balls around its two ends just touch; if they turn
// out not to touch, the step is cut back to the first ball's radius (Keinert et al. 2014, "Enhanced
// sphere tracing"; Balint and Valasek 2018 for the step from the slope). Near a surface, and in a long
// march, each field's lower bound along the line is used instead (`along…` in glsl/shape/): the step ends
// where the tangent or parabola below the field's value reaches 0, which is far beyond the ball for a
// grazing wave, and never beyond a surface. No step is longer than the distance that is free of every
// field.

uniform int uFieldSteps;   // maximum number of evaluations in one march

const float NEAR = 64.0;      // distance to the surface, in roundings, below which the line bounds are evaluated
const int PLAIN_STEPS = 12;   // consecutive steps after which the line bounds are evaluated anyway
const float RELAXED = 0.95;   // share of the step at which the balls would just touch
const float PLACE = 0.25;     // share of ROUNDING that is the error of a position
const float SHALLOW = 64.0;   // maximum length of the last step, in roundings along the ray
const float FLAT = 0.0625;    // least length of a gradient with which a value still locates the surface
const int LOOKS = 4;          // steps in which a march tries to reach a surface one rounding away

// Step from a point with no surface within `ball` in any direction, or none within `radius` ahead.
float fieldStep(float radius, float ball, float slope, float reach, float within) {
    float relaxed = max(radius, RELAXED * 2.0 * ball / (1.0 - clamp(slope, -1.0, 0.9)));
    // The ball may contain surfaces of other cells, which this cell does not list, and the next ball would
    // miss surfaces of this cell: no relaxed step may leave the cell.
    return relaxed < within ? relaxed : min(radius, reach);
}

// Returns the distance along the ray to the first hit before limit, or -1.
float marchFields(vec3 origin, vec3 d, float last, float limit, out float object, out bool limitReached) {
    float t = 0.0;
    float radius = 0.0;   // radius of the previous ball, or a longer free distance
    float taken = 0.0;    // length of the previous step
    float before = 0.0;   // value before the previous step
    float air = -1.0;     // distance to the last point in the air, or -1
    float solid = -1.0;   // distance to a point in a solid beyond that air, or -1
    int looks = LOOKS;
    limitReached = false;
    int steps = 0;
    int stepLimit = uFieldSteps;
    while (steps < stepLimit) {
        vec3 p;
        float f;
        float reach;
        float within;
        float slope;
        float rounding;
        bool near;
        // Steps by the value alone until near a surface. (Waves of one group run in lockstep on a GPU:
        // none evaluates more while another still needs only the value.)
        for (int plain = 0; ; ++plain) {
            p = origin + t * d;
            f = fieldsAhead(p, d, last, object, reach, within);
            COUNT_EVALUATIONS(1.0);
            ++steps;
            if (taken > radius && radius + f < taken) {
                t += radius - taken;
                taken = radius;
                continue;
            }
            slope = taken > 0.0 ? (f - before) / taken : -1.0;
            rounding = PLACE * ROUNDING * max(largest(p), largest(origin));
            before = f;
            near = f < NEAR * rounding;
            if (near || plain >= PLAIN_STEPS || solid >= 0.0) {
                break;
            }
            air = t;
            radius = f;
            taken = fieldStep(f, f, slope, reach, within);
            t += taken;
            if (t - taken + min(f, reach) >= limit) {
                return -1.0;
            }
        }
        if (solid < 0.0 ? f >= -rounding : f > 0.0) {
            air = t;
        }
        radius = f;
        float ball = f;
        if (near) {
            float errorBound;
            vec3 gradient = fieldGradient(p, object, errorBound);
            float closing = -dot(d, gradient);
            rounding = max(rounding, PLACE * errorBound);
            // A short gradient means a smaller value at the same distance.
            float touch = rounding * clamp(length(gradient), FLAT, 1.0);
            // The last step entered the solid, whatever the gradient says (it is inaccurate at edges): from
            // now on the interval is bisected.
            solid = f < -4.0 * touch && air >= 0.0 ? t : solid;
            if (solid >= 0.0) {
                solid = f <= 0.0 ? t : solid;
                if (abs(f) <= touch || solid - air <= rounding) {
                    return t < limit ? t : -1.0;
                }
                t = 0.5 * (air + solid);
                taken = 0.0;
                radius = 0.0;
                continue;
            }
            if (closing > 0.0 && f <= touch) {
                // There may be air just beyond an edge: the march prefers to end in the solid.
                if (f <= 0.0 || (looks == 0 && f <= SHALLOW * rounding * closing)) {
                    t = max(t + clamp(f / closing, -SHALLOW * rounding, SHALLOW * rounding), 0.0);
                    return t < limit ? t : -1.0;
                }
                looks = max(looks - 1, 0);
            } else {
                looks = LOOKS;
            }
            slope = -closing;
            // The march always advances, whatever the rounding.
            ball = max(abs(f), rounding);
            radius = ball;
        }
        radius = max(radius, fieldsFree(p, d, last, rounding / PLACE));
        COUNT_EVALUATIONS(1.0);
        if (solid >= 0.0) {
            radius = min(radius, 0.5 * (solid - t));
        }
        taken = solid >= 0.0 ? min(radius, reach) : fieldStep(radius, ball, slope, reach, within);
        t += taken;
        if (t - taken + min(radius, reach) >= limit) {
            return -1.0;
        }
    }
    limitReached = true;
    return -1.0;
}
