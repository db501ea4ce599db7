// The gradient that the user's text states, unchecked: NaN where the text divides by 0. Along an axis on
// which p is beyond the box, the value does not change.
vec3 statedByUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    vec3 gradient = user0_fieldGradient(clamp(p, -halfSize, halfSize));
    return gradient * inverseLipschitz * step(abs(p), halfSize);
}

// Gradient and value.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float LONGEST = 4.0;   // squared: no gradient is twice as long as the value may grow
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    vec3 gradient = statedByUser0(p, halfSize, inverseLipschitz);
    if (dot(gradient, gradient) <= LONGEST) {
        return vec4(gradient, value);
    }
    // At a tip or an axis the gradient is taken some roundings aside, off every line that a text is likely to
    // treat specially.
    vec3 aside = p + ROUNDING * max(largest(p), largest(halfSize)) * vec3(0.53, -0.62, 0.58);
    gradient = statedByUser0(aside, halfSize, inverseLipschitz);
    return vec4(dot(gradient, gradient) <= LONGEST ? gradient : vec3(0.0), value);
}
