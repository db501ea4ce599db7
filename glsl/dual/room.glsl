// Towards the middle, away from the nearest wall.
vec4 gdRoom(vec3 p, vec3 halfSize) {
    vec3 side = vec3(p.x < 0.0 ? 1.0 : -1.0, p.y < 0.0 ? 1.0 : -1.0, p.z < 0.0 ? 1.0 : -1.0);
    vec3 within = halfSize - abs(p);
    float least = min(within.x, min(within.y, within.z));
    if (least == within.x) {
        return vec4(side.x, 0.0, 0.0, least);
    }
    return least == within.y ? vec4(0.0, side.y, 0.0, least) : vec4(0.0, 0.0, side.z, least);
}
