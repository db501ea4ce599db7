// A line through the cells of repeated copies (Amanatides and Woo 1987), which are numbered
// first to last along each axis; along an axis without repetition there is one endless cell.

// The copy in whose cell the line begins, or enters them. False if it passes them all.
bool enterCopies(vec3 q, vec3 d, vec3 inverse, vec3 period, vec3 first, vec3 last, out vec3 copy) {
    vec3 a = ((first - 0.5) * period - q) * inverse;
    vec3 b = ((last + 0.5) * period - q) * inverse;
    vec3 enters = min(a, b);
    vec3 leaves = max(a, b);
    float t = max(max(enters.x, max(enters.y, enters.z)), 0.0);
    copy = clamp(floor((q + t * d) / period + 0.5), first, last);
    return t < min(leaves.x, min(leaves.y, leaves.z));
}

// Moves on to the next copy's cell. False beyond the last one.
bool nextCopy(vec3 q, vec3 inverse, vec3 period, vec3 first, vec3 last, inout vec3 copy) {
    vec3 side = vec3(inverse.x > 0.0 ? 1.0 : -1.0, inverse.y > 0.0 ? 1.0 : -1.0, inverse.z > 0.0 ? 1.0 : -1.0);
    vec3 faces = ((copy + 0.5 * side) * period - q) * inverse;
    float t = min(faces.x, min(faces.y, faces.z));
    copy += vec3(faces.x == t ? side.x : 0.0, faces.y == t ? side.y : 0.0, faces.z == t ? side.z : 0.0);
    return all(greaterThanEqual(copy, first)) && all(lessThanEqual(copy, last));
}
