// The least distance to the surfaces in cells. Among surfaces at exactly the same distance the
// lowest number wins, as with unrolled surfaces.

uniform int uGroups;       // index of the first group in the scene's data
uniform int uGroupCount;

void nearestListed(int first, int count, vec3 p, inout float nearest, inout float object) {
    for (int i = 0; i < count; ++i) {
        vec4 entry = sceneData(first + i);
        float candidate = surfaceOfKind(entry.y, int(entry.z), p);
        if (candidate < nearest || (candidate == nearest && entry.x < object)) {
            nearest = candidate;
            object = entry.x;
        }
    }
}

// Inside the grid, tests the surfaces that can be the nearest in the cell of p; outside, the surfaces of
// each group whose box is nearer than the least distance found. A group is two vectors: (least
// coordinates of its box, start of its list) and (greatest coordinates, length of the list).
void distanceInCells(vec3 p, inout float nearest, inout float object) {
    const float ROUNDED_DOWN = 0.999999;   // eight roundings of a length
    vec3 place;
    if (cellOf(p, place)) {
        vec4 cell = cellAt(place);
        nearestListed(int(cell.x), int(cell.y), p, nearest, object);
        return;
    }
    for (int i = 0; i < uGroupCount; ++i) {
        vec4 low = sceneData(uGroups + 2 * i);
        vec4 high = sceneData(uGroups + 2 * i + 1);
        float outside = length(max(max(low.xyz - p, p - high.xyz), 0.0));
        if (ROUNDED_DOWN * outside <= nearest) {
            nearestListed(int(low.w), int(high.w), p, nearest, object);
        }
    }
}
