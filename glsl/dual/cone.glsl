vec4 gdCone(vec3 p, float radius, float halfHeight) {
    float side;
    float apart = length(p.xz);
    vec2 q = fromCone(vec2(apart, p.y), radius, halfHeight, side);
    float off = length(q);
    // On the surface itself the way from it has no direction: that of the side or the base.
    vec2 slant = normalize(vec2(2.0 * halfHeight, radius));
    bool onBase = p.y + halfHeight < dot(slant, vec2(radius, -halfHeight) - vec2(apart, p.y));
    vec2 normal = off > 1e-6 * radius ? side * q / off : onBase ? vec2(0.0, -1.0) : slant;
    vec2 outward = normal.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, normal.y, outward.y, side * off);
}
