// The grid of cells (docs/architecture.md): each cell lists the surfaces that can be hit or be nearest
// in it. In the scene's data a cell is a vector (index of its first entry, number of entries), and an
// entry is (number of the surface, its kind, index of its values, its material). The directory holds
// one such entry for each surface, in the order of their numbers.

uniform vec3 uCellOrigin;   // corner with the least coordinates, metres
uniform vec3 uCellSize;     // metres
uniform vec3 uCellCount;
uniform int uCells;         // index of the first cell
uniform int uDirectory;     // index of the first entry of the directory

vec4 cellAt(vec3 place) {
    vec3 size = uCellCount;
    return sceneData(uCells + int((place.z * size.y + place.y) * size.x + place.x));
}

vec4 listed(vec4 cell, int place) {
    return sceneData(int(cell.x) + place);
}

vec4 entryOf(float object) {
    return sceneData(uDirectory + int(object) - 1);
}

// Returns whether p is in the grid, and the indices of its cell.
bool cellOf(vec3 p, out vec3 place) {
    place = floor((p - uCellOrigin) / uCellSize);
    return all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, uCellCount));
}
