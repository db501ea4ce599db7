// A cone about y: base at -halfHeight, tip at halfHeight. Exact: the nearest point of its
// side or of its base, in the half plane through the axis.
vec2 fromCone(vec2 q, float radius, float halfHeight, out float side) {
    vec2 rim = vec2(radius, -halfHeight);
    vec2 fromSide = fromSegment(q, vec2(0.0, halfHeight), rim);
    vec2 fromBase = fromSegment(q, vec2(0.0, -halfHeight), rim);
    bool inside = dot(vec2(2.0 * halfHeight, radius), q - rim) < 0.0 && q.y > -halfHeight;
    side = inside ? -1.0 : 1.0;
    return dot(fromSide, fromSide) < dot(fromBase, fromBase) ? fromSide : fromBase;
}

float sdCone(vec3 p, float radius, float halfHeight) {
    float side;
    vec2 q = fromCone(vec2(length(p.xz), p.y), radius, halfHeight, side);
    return side * length(q);
}
