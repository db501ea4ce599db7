// How fast the text's value grows along an axis, over h to either side as far as the box goes.
float growthOfUser0(vec3 p, vec3 offset, vec3 halfSize) {
    vec3 from = max(p - offset, -halfSize);
    vec3 to = min(p + offset, halfSize);
    return (user0_field(to) - user0_field(from)) / dot(to - from, vec3(1.0));
}

// Along an axis on which p is beyond the box, the value does not change.
vec3 quotientsOfUser0(vec3 p, float h, vec3 halfSize, float inverseLipschitz) {
    vec3 q = clamp(p, -halfSize, halfSize);
    vec2 e = vec2(h, 0.0);
    return inverseLipschitz * step(abs(p), halfSize) * vec3(
        growthOfUser0(q, e.xyy, halfSize), growthOfUser0(q, e.yxy, halfSize), growthOfUser0(q, e.yyx, halfSize));
}

// The power of 2 next to the largest coordinate: what the text's own rounding goes by. Cut out of
// the bits, since GLSL's exp2 need not give a power of 2.
float scaleOfUser0(vec3 p, vec3 halfSize) {
    const float ROOT_OF_2 = 1.41421356237;
    const uint EXPONENT = 0x7f800000u;
    float size = max(largest(p), 9.765625e-4 * largest(halfSize));
    return uintBitsToFloat(floatBitsToUint(ROOT_OF_2 * size) & EXPONENT);
}

// Its gradient and value for a march: right next to edges, and to some 1e-4.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    float h = 9.765625e-4 * scaleOfUser0(p, halfSize);
    return vec4(quotientsOfUser0(p, h, halfSize, inverseLipschitz), value);
}

// For a normal: differences of sixth order over h, 2 h and 4 h (Richardson's extrapolation). Wide
// steps leave the least rounding, and tell nothing where the surface bends or breaks within
// them. So they are halved until the fourth order says the same within half a rounding of the
// value; what never does, next to an edge, has the narrowest.
vec4 gnUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float WIDEST = 0.25;            // of the scale, to either side
    const float NARROWEST = 9.765625e-4;
    const float AGREE = 5.9604645e-8;     // half of 2^-23
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    float scale = scaleOfUser0(p, halfSize);
    // Nothing is known beyond the box.
    float h = clamp(-outside, 16.0 * NARROWEST * scale, WIDEST * scale);
    vec3 wide = quotientsOfUser0(p, h, halfSize, inverseLipschitz);
    vec3 middle = quotientsOfUser0(p, 0.5 * h, halfSize, inverseLipschitz);
    for (h *= 0.25; h >= NARROWEST * scale; h *= 0.5) {
        vec3 narrow = quotientsOfUser0(p, h, halfSize, inverseLipschitz);
        vec3 gradient = (64.0 * narrow - 20.0 * middle + wide) / 45.0;
        vec3 off = (4.0 * narrow - 5.0 * middle + wide) / 45.0;
        if (length(off) <= AGREE * scale / h * length(gradient)) {
            return vec4(gradient, value);
        }
        wide = middle;
        middle = narrow;
    }
    return vec4(middle, value);
}
