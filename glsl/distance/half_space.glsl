// A half-space: solid where the unit normal times p is below the offset. Exact.
float sdHalfSpace(vec3 p, vec3 normal, float offset) {
    return dot(normal, p) - offset;
}
