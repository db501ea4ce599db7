// Updates the least value of the marched fields with those in the cell of p. `reach` is the
// distance along d to the end of the cell, or to the grid; `within` is the distance that certainly
// stays in the cell.
void fieldsInCells(vec3 p, vec3 d, float last, inout float nearest, inout float object, inout float reach, inout float within) {
    vec4 cell;
    if (cellAhead(p, d, cell, reach, within)) {
        for (int i = 0; i < int(cell.y); ++i) {
            vec4 entry = listed(cell, i);
            float candidate = fieldOfKind(entry.y, int(entry.z), p, last == entry.x);
            if (candidate < nearest) { nearest = candidate; object = entry.x; }
        }
    }
}
