// Material of the wall of a room that turned a wave, from the turn in the room's own axes. Each pair is
// the wall with the lower coordinate, then the other one.
float materialOfWall(vec3 turned, vec2 x, vec2 y, vec2 z) {
    vec3 size = abs(turned);
    float ofX = turned.x > 0.0 ? x.x : x.y;
    float ofY = turned.y > 0.0 ? y.x : y.y;
    float ofZ = turned.z > 0.0 ? z.x : z.y;
    return size.x >= max(size.y, size.z) ? ofX : size.y >= size.z ? ofY : ofZ;
}
