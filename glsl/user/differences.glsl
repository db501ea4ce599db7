// First and second derivative of the user's function along an axis at p, where its value is `value`, from
// values at distance h on either side. Next to a face of the box, values at h and 2 h away from the face
// are used, which give no second derivative (0). The errors are of order h², so that differences between
// steps estimate them.
vec2 growthOfUser0(vec3 p, float value, vec3 axis, float h, vec3 halfSize) {
    float along = dot(p, axis);
    float end = dot(halfSize, axis);
    h = min(h, 0.5 * end);
    bool isAtFace = abs(along) + h > end;
    float inwards = along > 0.0 ? -h : h;
    vec3 one = p + (isAtFace ? inwards : h) * axis;
    vec3 other = p + (isAtFace ? 2.0 * inwards : -h) * axis;
    float atOne = numberOfUser0(one);
    float atOther = numberOfUser0(other);
    float toOne = dot(one - p, axis);
    float toOther = dot(other - p, axis);
    float apart = dot(one - other, axis);
    // At a face: the slope at p of the parabola through the three values.
    float slope = isAtFace
        ? ((atOther - value) / toOther * toOne - (atOne - value) / toOne * toOther) / apart
        : (atOne - atOther) / apart;
    float bend = isAtFace ? 0.0 : ((atOne - value) + (atOther - value)) / (h * h);
    return vec2(slope, bend);
}

// Along an axis on which p is beyond the box, the value is constant.
vec3 quotientsOfUser0(
    vec3 p, float value, float h, vec3 halfSize, float inverseLipschitz, out vec3 bends
) {
    vec3 q = clamp(p, -halfSize, halfSize);
    float own = value / inverseLipschitz;
    vec2 e = vec2(1.0, 0.0);
    vec2 x = growthOfUser0(q, own, e.xyy, h, halfSize);
    vec2 y = growthOfUser0(q, own, e.yxy, h, halfSize);
    vec2 z = growthOfUser0(q, own, e.yyx, h, halfSize);
    vec3 scale = inverseLipschitz * step(abs(p), halfSize);
    bends = scale * vec3(x.y, y.y, z.y);
    return scale * vec3(x.x, y.x, z.x);
}

// The power of 2 next to the largest coordinate, which determines the rounding error of the user's value.
// It is computed from the float's bits, because GLSL's exp2 may not give an exact power of 2.
float scaleOfUser0(vec3 p, vec3 halfSize) {
    const float ROOT_OF_2 = 1.41421356237;
    const uint EXPONENT = 0x7f800000u;
    float size = max(largest(p), 9.765625e-4 * largest(halfSize));
    return uintBitsToFloat(floatBitsToUint(ROOT_OF_2 * size) & EXPONENT);
}

// Gradient and value for a march: correct next to edges, and elsewhere to about 1e-4.
vec4 gdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    float h = 9.765625e-4 * scaleOfUser0(p, halfSize);
    vec3 bends;
    return vec4(quotientsOfUser0(p, value, h, halfSize, inverseLipschitz, bends), value);
}

// Gradient for a normal: differences of sixth order over h, 2 h and 4 h (Richardson's extrapolation). Wide
// steps have the least rounding error, but are wrong where the surface bends or breaks within them. So the
// step is halved until the fourth order agrees within half a rounding of the value; if it never does, next
// to an edge, the narrowest step is used. An edge 16/9 h away does not change that difference, but it
// changes the differences of the second derivatives, which must therefore agree as well.
vec4 gnUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    const float WIDEST = 0.25;            // share of the scale, to either side
    const float NARROWEST = 9.765625e-4;
    const float AGREE = 5.9604645e-8;     // half of 2^-23
    const float BENDS = 0.5;              // weight of second derivatives: three values have more rounding than two
    float value = sdUser0(p, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    if (outside >= value) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    float scale = scaleOfUser0(p, halfSize);
    // The field is not evaluated beyond the box.
    float h = clamp(-outside, 16.0 * NARROWEST * scale, WIDEST * scale);
    vec3 wideBends, middleBends, narrowBends;
    vec3 wide = quotientsOfUser0(p, value, h, halfSize, inverseLipschitz, wideBends);
    vec3 middle = quotientsOfUser0(p, value, 0.5 * h, halfSize, inverseLipschitz, middleBends);
    for (h *= 0.25; h >= NARROWEST * scale; h *= 0.5) {
        vec3 narrow = quotientsOfUser0(p, value, h, halfSize, inverseLipschitz, narrowBends);
        vec3 gradient = (64.0 * narrow - 20.0 * middle + wide) / 45.0;
        vec3 off = (4.0 * narrow - 5.0 * middle + wide) / 45.0;
        vec3 bendOff = BENDS * h * (4.0 * narrowBends - 5.0 * middleBends + wideBends) / 45.0;
        float most = AGREE * scale / h * length(gradient);
        if (length(off) <= most && length(bendOff) <= most) {
            return vec4(gradient, value);
        }
        wide = middle;
        middle = narrow;
        wideBends = middleBends;
        middleBends = narrowBends;
    }
    return vec4(middle, value);
}
