// The inside of a box.

// Signed distance to the walls of a box from its inside. Exact in the air; in the surrounding solid the
// magnitude is the largest distance beyond the plane of a wall.
float sdRoom(vec3 p, vec3 halfSize) {
    vec3 within = halfSize - abs(p);
    return min(within.x, min(within.y, within.z));
}

// Distance to the three walls ahead along d, and its gradient. A wall behind cannot be hit, so the wall
// that a wave leaves is skipped.
float sdRoomDirected(vec3 p, vec3 d, vec3 halfSize) {
    vec3 ahead = vec3(d.x < 0.0 ? -p.x : p.x, d.y < 0.0 ? -p.y : p.y, d.z < 0.0 ? -p.z : p.z);
    vec3 within = halfSize - ahead;
    const float NEVER = 1e30;
    within = vec3(d.x == 0.0 ? NEVER : within.x, d.y == 0.0 ? NEVER : within.y, d.z == 0.0 ? NEVER : within.z);
    return min(within.x, min(within.y, within.z));
}

vec3 gradientRoomDirected(vec3 p, vec3 d, vec3 halfSize) {
    vec3 projected = p;
    vec3 normal;
    projectRoom(projected, d, halfSize, normal);
    return normal;
}

// Gradient and distance. The gradient points towards the middle, away from the nearest wall.
vec4 gdRoom(vec3 p, vec3 halfSize) {
    vec3 side = vec3(p.x < 0.0 ? 1.0 : -1.0, p.y < 0.0 ? 1.0 : -1.0, p.z < 0.0 ? 1.0 : -1.0);
    vec3 within = halfSize - abs(p);
    if (within.x <= within.y && within.x <= within.z) {
        return vec4(side.x, 0.0, 0.0, within.x);
    }
    return within.y <= within.z ? vec4(0.0, side.y, 0.0, within.y) : vec4(0.0, 0.0, side.z, within.z);
}

// Hit of a ray with the walls of a box from the inside: the nearest of the three walls ahead. The ray
// always hits one, so no wave can leak; a wall behind is never hit, so a wave cannot hit the wall that
// it leaves.
float hitRoom(vec3 p, vec3 d, vec3 halfSize) {
    vec3 t = (halfSize - headingSigns(d) * p) * inverseSpeeds(d);
    return max(min(t.x, min(t.y, t.z)), 0.0);
}

// Projects a hit point onto the nearest of the three walls ahead along d, and returns the normal there,
// which points into the room.
void projectRoom(inout vec3 p, vec3 d, vec3 halfSize, out vec3 normal) {
    vec3 ahead = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
    vec3 within = halfSize - ahead * p;
    // A wall parallel to the wave cannot be hit.
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
