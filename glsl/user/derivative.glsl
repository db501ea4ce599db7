// The gradient of the user's field 0, differentiated from its text, and the value. Along an axis on which p
// is beyond the box, the value is constant.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float LONGEST = 4.0;   // squared: twice the greatest growth of the value
    float outside = sdBox(p, halfSize);
    vec3 scale = inverseLipschitz * step(abs(p), halfSize);
    vec3 at = p;
    float value = 0.0;
    vec3 gradient = vec3(0.0);
    // An undefined gradient (at a pole of the text) is evaluated once more some roundings aside, off every line
    // that a text is likely to treat specially.
    int turns = turnsOf(2, largest(p));
    for (int turn = 0; turn < turns; ++turn) {
        float own = inverseLipschitz * dual0_field(clamp(at, -halfSize, halfSize), gradient);
        value = turn == 0 ? own : value;
        gradient *= scale;
        // The other way round, a NaN would pass.
        if (dot(gradient, gradient) <= LONGEST) {
            break;
        }
        gradient = vec3(0.0);
        at = p + ROUNDING * max(largest(p), largest(halfSize)) * vec3(0.53, -0.62, 0.58);
    }
    return outside >= value ? vec4(gradientBox(p, halfSize), outside) : vec4(gradient, value);
}

// The same for a normal.
vec4 gnUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    return gdUser0(p, halfSize, inverseLipschitz);
}

// Value and slope along d: one evaluation. Beyond the box, and where the slope is steeper than the value can
// grow, those of the box or a slope of -1.
vec2 slopeUser0(vec3 p, vec3 d, vec3 halfSize, float inverseLipschitz) {
    const float STEEPEST = 2.0;
    float slope;
    vec3 along = d * step(abs(p), halfSize);
    float value = inverseLipschitz * slope0_field(clamp(p, -halfSize, halfSize), along, slope);
    slope *= inverseLipschitz;
    float outside = sdBox(p, halfSize);
    float inside = abs(slope) <= STEEPEST ? slope : -1.0;
    return outside >= value ? vec2(outside, dot(gradientBox(p, halfSize), d)) : vec2(value, inside);
}
