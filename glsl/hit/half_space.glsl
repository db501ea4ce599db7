// Where a ray from the air meets a half-space.
float hitHalfSpace(vec3 p, vec3 d, vec3 normal, float offset, float slack) {
    float closing = -dot(normal, d);
    return closing > 0.0 ? max((dot(normal, p) - offset) / closing, 0.0) : NO_HIT;
}
