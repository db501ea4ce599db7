// The vector to p from the nearest point of the segment a b.
vec2 fromSegment(vec2 p, vec2 a, vec2 b) {
    vec2 along = b - a;
    return p - a - along * clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
}
