// The gradient from the user's fieldGradient, unchecked: NaN where it divides by 0. Along an axis on
// which p is beyond the box, the value is constant.
vec3 statedByUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    vec3 gradient = user0_fieldGradient(clamp(p, -halfSize, halfSize));
    return gradient * inverseLipschitz * step(abs(p), halfSize);
}

// Gradient and value.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float LONGEST = 4.0;   // squared: twice the greatest growth of the value
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    vec3 gradient = statedByUser0(p, halfSize, inverseLipschitz);
    if (dot(gradient, gradient) <= LONGEST) {
        return vec4(gradient, value);
    }
    // An undefined gradient (at a tip or an axis) is evaluated some roundings aside, off every line that a
    // user's function is likely to treat specially.
    vec3 aside = p + ROUNDING * max(largest(p), largest(halfSize)) * vec3(0.53, -0.62, 0.58);
    gradient = statedByUser0(aside, halfSize, inverseLipschitz);
    return vec4(dot(gradient, gradient) <= LONGEST ? gradient : vec3(0.0), value);
}

vec2 slopeUser0(vec3 p, vec3 d, vec3 halfSize, float inverseLipschitz) {
    vec4 gradient = gdUser0(p, halfSize, inverseLipschitz);
    return vec2(gradient.w, dot(gradient.xyz, d));
}
