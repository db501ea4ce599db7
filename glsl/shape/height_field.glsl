// Ground given by an image of heights.

// Ground given by an image of heights, within a box. The image is in the scene's data: pixels from index
// `first`, row by row, size.x per row, interpolated bilinearly. The height above the ground, divided by its
// Lipschitz constant, is a lower bound of the distance. Returns the ground's slopes along x and z, and its
// height.
vec3 groundAt(vec3 p, vec3 halfSize, int first, ivec2 size) {
    vec2 cells = vec2(size - 1);
    vec2 place = clamp((p.xz / (2.0 * halfSize.xz) + 0.5) * cells, vec2(0.0), cells);
    vec2 cell = min(floor(place), cells - 1.0);
    // Relative to the cell's own corner: a coordinate relative to the whole image would lose
    // digits.
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

vec4 gdHeightField(vec3 p, vec3 halfSize, float inverseGrowth, int first, ivec2 size) {
    vec3 held = clamp(p, -halfSize, halfSize);
    vec3 ground = groundAt(held, halfSize, first, size);
    float above = (held.y - ground.z) * inverseGrowth;
    float outside = sdBox(p, halfSize);
    if (outside > above) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    // The ground is constant beyond the box.
    vec3 growth = vec3(-ground.x, 1.0, -ground.y) * step(abs(p), halfSize);
    return vec4(growth * inverseGrowth, above);
}

// Within one cell of the image the height above the ground is a quadratic function along a line. Beyond
// the box the ground is constant, and only the distance to the box counts.
vec4 aboveGroundAlong(float side, vec3 p, vec3 d, vec3 halfSize, float inverseGrowth, int first, ivec2 size, float errorBound) {
    vec3 held = clamp(p, -halfSize, halfSize);
    vec2 cells = vec2(size - 1);
    vec2 metres = 2.0 * halfSize.xz / cells;
    vec2 place = clamp((held.xz / (2.0 * halfSize.xz) + 0.5) * cells, vec2(0.0), cells);
    // On the border between two cells, the cell ahead is used.
    vec2 cell = vec2(d.x < 0.0 ? ceil(place.x) - 1.0 : floor(place.x), d.z < 0.0 ? ceil(place.y) - 1.0 : floor(place.y));
    cell = clamp(cell, vec2(0.0), cells - 1.0);
    int at = first + int(cell.y) * size.x + int(cell.x);
    float a = sceneData(at).x;
    float b = sceneData(at + 1).x;
    float c = sceneData(at + size.x).x;
    float e = sceneData(at + size.x + 1).x;
    vec2 within = clamp((held.xz - (cell * metres - halfSize.xz)) / metres, 0.0, 1.0);
    float height = mix(mix(a, b, within.x), mix(c, e, within.x), within.y);
    vec2 speed = d.xz / metres;
    float rise = mix(b - a, e - c, within.y) * speed.x + mix(c - a, e - b, within.x) * speed.y;
    float bend = 2.0 * (a - b - c + e) * speed.x * speed.y;
    vec2 face = (cell + vec2(d.x < 0.0 ? 0.0 : 1.0, d.z < 0.0 ? 0.0 : 1.0)) * metres - halfSize.xz;
    vec2 way = vec2(
        d.x == 0.0 ? NO_END : (face.x - p.x) / d.x,
        d.z == 0.0 ? NO_END : (face.y - p.z) / d.z);
    float reach = max(min(way.x, way.y), 0.0) + errorBound;
    float full = 2.0 * halfSize.y;
    return vec4(
        side * inverseGrowth * (held.y - full * (height - 0.5)),
        side * inverseGrowth * (d.y - full * rise),
        max(side * inverseGrowth * full * bend, 0.0),
        reach);
}

vec4 alongHeightField(vec3 p, vec3 d, vec3 halfSize, float inverseGrowth, int first, ivec2 size, float errorBound) {
    float outside = sdBox(p, halfSize);
    vec4 box = vec4(outside, dot(gradientBox(p, halfSize), d), 0.0, NO_END);
    if (outside > errorBound) {
        return box;
    }
    vec4 ground = aboveGroundAlong(1.0, p, d, halfSize, inverseGrowth, first, size, errorBound);
    return upperAlong(ground, box, errorBound);
}

vec4 alongHeightFieldSolid(vec3 p, vec3 d, vec3 halfSize, float inverseGrowth, int first, ivec2 size, float errorBound) {
    float within = -sdBox(p, halfSize);
    vec4 box = concaveAlong(within, exitBox(p, d, halfSize));
    if (within < -errorBound) {
        return box;
    }
    vec4 ground = aboveGroundAlong(-1.0, p, d, halfSize, inverseGrowth, first, size, errorBound);
    return lowerAlong(ground, box, errorBound);
}
