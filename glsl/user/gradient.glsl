// The gradient from the user's fieldGradient, unchecked: NaN where it divides by 0. Along an axis on which
// p is beyond the box, the value is constant.
vec3 statedByUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    vec3 gradient = user0_fieldGradient(clamp(p, -halfSize, halfSize));
    return gradient * inverseLipschitz * step(abs(p), halfSize);
}

// Gradient and value.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float LONGEST = 4.0;   // squared: twice the greatest growth of the value
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    vec3 at = p;
    vec3 gradient = vec3(0.0);
    // An undefined gradient (at a tip or an axis) is evaluated once more some roundings aside, off every line
    // that a user's function is likely to treat specially.
    int turns = turnsOf(2, largest(p));
    for (int turn = 0; turn < turns; ++turn) {
        gradient = statedByUser0(at, halfSize, inverseLipschitz);
        // The other way round, a NaN would pass.
        if (dot(gradient, gradient) <= LONGEST) {
            break;
        }
        gradient = vec3(0.0);
        at = p + ROUNDING * max(largest(p), largest(halfSize)) * vec3(0.53, -0.62, 0.58);
    }
    return outside >= value ? vec4(gradientBox(p, halfSize), outside) : vec4(gradient, value);
}

// Value and slope along d. Beyond the box, and where the slope is steeper than the value can grow, those of the
// box or a slope of -1.
vec2 slopeUser0(vec3 p, vec3 d, vec3 halfSize, float inverseLipschitz) {
    const float STEEPEST = 2.0;
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    float slope = dot(statedByUser0(p, halfSize, inverseLipschitz), d);
    float inside = abs(slope) <= STEEPEST ? slope : -1.0;
    return outside >= value ? vec2(outside, dot(gradientBox(p, halfSize), d)) : vec2(value, inside);
}
