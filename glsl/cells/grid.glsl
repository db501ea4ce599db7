// Cells of space (docs/architecture.md): the surfaces that matter in each place. In the scene's data a
// cell is a vector (first of its list, length of the list); an entry of a list is (number of the
// surface, its kind, index of its values, its material). The directory has such an entry for each
// surface, by its number.

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

// Whether p is in the grid, and in which cell.
bool cellOf(vec3 p, out vec3 place) {
    place = floor((p - uCellOrigin) / uCellSize);
    return all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, uCellCount));
}
