// Where a ray meets the walls of a box from its inside: the nearest of the three walls
// ahead. It always meets one, so a wave cannot leak; a wall behind is never met, so a wave
// cannot meet the wall it leaves.
float hitRoom(vec3 p, vec3 d, vec3 halfSize) {
    vec3 inverse = abs(safeInverse(d));
    vec3 ahead = vec3(d.x < 0.0 ? -p.x : p.x, d.y < 0.0 ? -p.y : p.y, d.z < 0.0 ? -p.z : p.z);
    vec3 t = (halfSize - ahead) * inverse;
    return max(min(t.x, min(t.y, t.z)), 0.0);
}
