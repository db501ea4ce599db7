// Its normal is that of the region that the point lies in, which rounding cannot turn next to the
// surface: the way from the nearest point is taken only beyond the tip and the rim.
vec4 gdCone(vec3 p, float radius, float halfHeight) {
    float side;
    float apart = length(p.xz);
    vec2 q = vec2(apart, p.y);
    float off = length(fromCone(q, radius, halfHeight, side));
    vec2 slant = normalize(vec2(2.0 * halfHeight, radius));
    vec2 fromRim = q - vec2(radius, -halfHeight);
    float beyondSide = dot(slant, fromRim);
    float below = -fromRim.y;
    vec2 fromTip = q - vec2(0.0, halfHeight);
    vec2 upwards = vec2(-slant.y, slant.x);
    vec2 normal = slant;
    if (beyondSide <= 0.0 && below <= 0.0) {
        normal = beyondSide > below ? slant : vec2(0.0, -1.0);
    } else if (below > 0.0 && fromRim.x <= 0.0) {
        normal = vec2(0.0, -1.0);
    } else if (dot(upwards, fromRim) < 0.0) {
        normal = fromRim / max(length(fromRim), 1e-30);
    } else if (dot(upwards, fromTip) > 0.0) {
        normal = fromTip / max(length(fromTip), 1e-30);
    }
    vec2 outward = normal.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, normal.y, outward.y, side * off);
}
