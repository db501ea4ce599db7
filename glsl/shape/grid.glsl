// Distances sampled on a grid, within a box.

// The samples are in the scene's data from index `first`: x fastest, then y, then z. Each vector has the values at
// (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1). Returns gradient and value of the trilinear
// interpolation.
vec4 samplesAt(vec3 p, vec3 halfSize, int first, ivec3 size) {
    vec3 cells = vec3(size - 1);
    vec3 metres = 2.0 * halfSize / cells;
    vec3 cell = min(floor(clamp((p + halfSize) / metres, vec3(0.0), cells)), cells - 1.0);
    // Relative to the cell's own corner: a coordinate relative to the whole grid would lose digits.
    vec3 within = clamp((p - (cell * metres - halfSize)) / metres, 0.0, 1.0);
    int at = first + (int(cell.z) * size.y + int(cell.y)) * size.x + int(cell.x);
    vec4 below = sceneData(at);
    vec4 above = sceneData(at + size.x * size.y);
    vec4 layer = mix(below, above, within.z);
    vec4 rise = above - below;
    vec2 rows = mix(layer.xz, layer.yw, within.x);
    vec2 rises = mix(rise.xz, rise.yw, within.x);
    vec3 growth = vec3(
        mix(layer.y - layer.x, layer.w - layer.z, within.y),
        rows.y - rows.x,
        mix(rises.x, rises.y, within.y));
    return vec4(growth / metres, mix(rows.x, rows.y, within.y));
}

float sdGrid(vec3 p, vec3 halfSize, int first, ivec3 size) {
    float value = samplesAt(clamp(p, -halfSize, halfSize), halfSize, first, size).w;
    return max(value, sdBox(p, halfSize));
}

vec4 gdGrid(vec3 p, vec3 halfSize, int first, ivec3 size) {
    vec4 inside = samplesAt(clamp(p, -halfSize, halfSize), halfSize, first, size);
    float outside = sdBox(p, halfSize);
    if (outside > inside.w) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    // The value is constant beyond the box.
    return vec4(inside.xyz * step(abs(p), halfSize), inside.w);
}
