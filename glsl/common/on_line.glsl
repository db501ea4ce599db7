// A field at a point of a line: what a march needs to know of it there, in both directions of the line.

struct OnLine {
    float value;   // metres
    float slope;   // change of the value per metre, or UNKNOWN
    float sag;     // the second derivative is at least -sag, 1/m, in the ball of radius `reach`
    float rise;    // the second derivative is at most `rise`, 1/m, in the ball of radius `reach`
    float reach;   // metres; 0 where the second derivative has no known limits
};

// The slope of a field of which only the value is known.
const float UNKNOWN = 2.0;

OnLine valueOnLine(float value) {
    return OnLine(value, UNKNOWN, 0.0, 0.0, 0.0);
}

// From a gradient and value, and from (sag, rise, reach).
OnLine onLine(vec4 gradient, vec3 d, vec3 bend) {
    return OnLine(gradient.w, dot(gradient.xyz, d), bend.x, bend.y, bend.z);
}

// The bend of the distance from a convex solid, a line or a point that is `away` metres away: within half of this
// distance the second derivative is at most 1 / (away / 2), and never negative.
vec3 bendOfDistance(float away) {
    return away > 0.0 ? vec3(0.0, 2.0 / away, 0.5 * away) : vec3(0.0);
}

// The value times a factor of at most 1.
OnLine onLineScaled(OnLine a, float factor) {
    return OnLine(factor * a.value, factor * a.slope, factor * a.sag, factor * a.rise, a.reach);
}

OnLine onLineComplement(OnLine a) {
    return OnLine(-a.value, -a.slope, a.rise, a.sag, a.reach);
}

// The distance over which the line is certainly free of the field.
float freeOnLine(OnLine a) {
    return freeAlong(vec4(a.value, a.slope, a.sag, a.reach), NO_END);
}
