// Puts a point that is met onto the box, and says the normal there: of the faces that
// look against the direction d, the one the point is furthest out of. An edge or a
// vertex belongs to one of its faces, so no normal ever looks along d.
void landBox(inout vec3 p, vec3 d, vec3 halfSize, out vec3 normal) {
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    vec3 beyond = abs(p) - halfSize;
    vec3 facing = -side * d;
    const float NEVER = -1e30;
    beyond = vec3(
        facing.x > 0.0 ? beyond.x : NEVER,
        facing.y > 0.0 ? beyond.y : NEVER,
        facing.z > 0.0 ? beyond.z : NEVER);
    if (beyond.x >= beyond.y && beyond.x >= beyond.z) {
        p.x = side.x * halfSize.x;
        normal = vec3(side.x, 0.0, 0.0);
    } else if (beyond.y >= beyond.z) {
        p.y = side.y * halfSize.y;
        normal = vec3(0.0, side.y, 0.0);
    } else {
        p.z = side.z * halfSize.z;
        normal = vec3(0.0, 0.0, side.z);
    }
}
