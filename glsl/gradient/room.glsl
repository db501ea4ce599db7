// Distance to the three walls ahead along d, and where it grows: a wall behind cannot be
// met, and so the wall that a wave leaves is out of its way.
float sdRoomAhead(vec3 p, vec3 d, vec3 halfSize) {
    vec3 ahead = vec3(d.x < 0.0 ? -p.x : p.x, d.y < 0.0 ? -p.y : p.y, d.z < 0.0 ? -p.z : p.z);
    vec3 within = halfSize - ahead;
    const float NEVER = 1e30;
    within = vec3(d.x == 0.0 ? NEVER : within.x, d.y == 0.0 ? NEVER : within.y, d.z == 0.0 ? NEVER : within.z);
    return min(within.x, min(within.y, within.z));
}

vec3 gradientRoomAhead(vec3 p, vec3 d, vec3 halfSize) {
    vec3 landed = p;
    vec3 normal;
    landRoom(landed, d, halfSize, normal);
    return normal;
}
