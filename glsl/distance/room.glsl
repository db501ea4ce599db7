// Signed distance to the walls of a box from its inside. Exact in the air; in the
// solid around it the magnitude is that of the plane passed furthest.
float sdRoom(vec3 p, vec3 halfSize) {
    vec3 within = halfSize - abs(p);
    return min(within.x, min(within.y, within.z));
}
