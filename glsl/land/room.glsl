// Puts a point that is met onto the nearest of the three walls ahead along d, and says
// the normal there, which looks into the room.
void landRoom(inout vec3 p, vec3 d, vec3 halfSize, out vec3 normal) {
    vec3 ahead = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
    vec3 within = halfSize - ahead * p;
    // A wall along which the wave moves is not ahead.
    const float NEVER = 1e30;
    within = vec3(d.x == 0.0 ? NEVER : within.x, d.y == 0.0 ? NEVER : within.y, d.z == 0.0 ? NEVER : within.z);
    if (within.x <= within.y && within.x <= within.z) {
        p.x = ahead.x * halfSize.x;
        normal = vec3(-ahead.x, 0.0, 0.0);
    } else if (within.y <= within.z) {
        p.y = ahead.y * halfSize.y;
        normal = vec3(0.0, -ahead.y, 0.0);
    } else {
        p.z = ahead.z * halfSize.z;
        normal = vec3(0.0, 0.0, -ahead.z);
    }
}
