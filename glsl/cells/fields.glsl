// The least value of the marched fields in the cell of p, how far ahead it holds, and how far the
// same fields are evaluated.
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
