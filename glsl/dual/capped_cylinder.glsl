vec4 gdCappedCylinder(vec3 p, float radius, float halfHeight) {
    float apart = length(p.xz);
    vec2 beyond = vec2(apart - radius, abs(p.y) - halfHeight);
    vec2 shares = cornerShares(beyond);
    vec2 outward = shares.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, p.y < 0.0 ? -shares.y : shares.y, outward.y, sdCorner(beyond));
}
