vec4 gdPrism(vec3 p, vec2 a, vec2 b, vec2 c, float halfDepth) {
    vec3 triangle = triangleDistance(p.xy, a, b, c);
    vec2 beyond = vec2(triangle.z, abs(p.z) - halfDepth);
    vec2 shares = cornerShares(beyond);
    return vec4(shares.x * triangle.xy, p.z < 0.0 ? -shares.y : shares.y, sdCorner(beyond));
}
