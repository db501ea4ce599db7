// A lower bound of a field's value along a line: value + slope t - bend t^2 / 2, which holds for
// t from 0 to reach, as the vector (value, slope, bend, reach); t and reach in metres.
//
// Theory. Where the second derivative along every line is at least -bend, Taylor's formula gives
// such a bound. From outside, the distance to a convex solid has bend 0. Inside the solid, the
// distance to its surface is concave along the line, and the chord to the exit is a lower bound.

const float NO_END = 1e20;   // beyond every length here, and does not overflow when scaled

// Length along the line over which the bound stays greater than 0. The start may lie up to errorBound
// inside the solid.
float freeAlong(vec4 bound, float errorBound) {
    if (bound.x < -errorBound) {
        return 0.0;
    }
    float value = max(bound.x, 0.0);
    float root = sqrt(bound.y * bound.y + 2.0 * bound.z * value);
    float way = NO_END;
    if (bound.y < 0.0) {
        way = 2.0 * value / (root - bound.y);
    } else if (bound.z > 0.0) {
        way = (bound.y + root) / bound.z;
    }
    return min(way, bound.w);
}

// The bound that holds for every field: its value falls by at most one metre per metre.
vec4 plainAlong(float value) {
    return vec4(value, -1.0, 0.0, NO_END);
}

// Uses the plain bound instead where it reaches further.
vec4 orPlain(vec4 bound, float errorBound) {
    return freeAlong(bound, errorBound) < bound.x ? plainAlong(bound.x) : bound;
}

// Bound of the minimum of two values: that of the lower one while it stays below the other, or a
// bound below both, whichever reaches further.
vec4 lowerAlong(vec4 a, vec4 b, float errorBound) {
    vec4 low = a.x < b.x ? a : b;
    vec4 high = a.x < b.x ? b : a;
    float reach = min(a.w, b.w);
    vec4 gap = vec4(high.xy - low.xy, max(high.z - low.z, 0.0), reach);
    vec4 apart = vec4(low.xyz, freeAlong(gap, 0.0));
    vec4 below = vec4(low.x, min(a.y, b.y), max(a.z, b.z), reach);
    return freeAlong(apart, errorBound) > freeAlong(below, errorBound) ? apart : below;
}

// Bound of the maximum of two values: both bounds are valid, and the one that reaches further is
// used.
vec4 upperAlong(vec4 a, vec4 b, float errorBound) {
    return freeAlong(a, errorBound) >= freeAlong(b, errorBound) ? a : b;
}

// Bound of a value that is concave along the line up to a point in the air `way` metres ahead.
vec4 concaveAlong(float value, float way) {
    float end = max(way, 0.0);
    return vec4(value, -max(value, 0.0) / max(end, 1e-30), 0.0, end);
}
