// Ground under an image of heights, within a box. The image lies in the scene's data: its
// pixels from first on, row by row, size.x of them in a row. Between pixels it is bilinear.
// The height above the ground is divided by the greatest growth there is: a bound.
vec3 groundAt(vec3 p, vec3 halfSize, int first, ivec2 size) {
    vec2 cells = vec2(size - 1);
    vec2 place = clamp((p.xz / (2.0 * halfSize.xz) + 0.5) * cells, vec2(0.0), cells);
    vec2 cell = min(floor(place), cells - 1.0);
    // From the cell's own corner: a share of the whole image has lost the digits.
    vec2 metres = 2.0 * halfSize.xz / cells;
    vec2 within = clamp((p.xz - (cell * metres - halfSize.xz)) / metres, 0.0, 1.0);
    int at = first + int(cell.y) * size.x + int(cell.x);
    float a = sceneData(at).x;
    float b = sceneData(at + 1).x;
    float c = sceneData(at + size.x).x;
    float d = sceneData(at + size.x + 1).x;
    vec2 rows = mix(vec2(a, c), vec2(b, d), within.x);
    vec2 slope = vec2(mix(b - a, d - c, within.y), rows.y - rows.x) * cells / (2.0 * halfSize.xz);
    return vec3(2.0 * halfSize.y * slope, 2.0 * halfSize.y * (mix(rows.x, rows.y, within.y) - 0.5));
}

float sdHeightField(vec3 p, vec3 halfSize, float inverseGrowth, int first, ivec2 size) {
    vec3 held = clamp(p, -halfSize, halfSize);
    float ground = groundAt(held, halfSize, first, size).z;
    return max((held.y - ground) * inverseGrowth, sdBox(p, halfSize));
}
