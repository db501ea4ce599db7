// A user's field within its box, in a room: both are centred boxes.
float boxDistance(vec3 p, vec3 halfSize) {
    vec3 q = abs(p) - halfSize;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

float map(vec3 p) {
    vec3 q = p - FIELD_POSITION;
    float solid = max(field(q) / GROWTH, boxDistance(q, FIELD_HALF));
    return min(solid, -boxDistance(p, ROOM_HALF));
}
