// Adds the marched fields in the cell of p.
void fieldsInCells(vec3 p, vec3 d, float last, float errorBound, inout Ahead ahead) {
    vec4 cell;
    if (cellAhead(p, d, cell, ahead.cell, ahead.within)) {
        for (int i = 0; i < int(cell.y); ++i) {
            vec4 entry = listed(cell, i);
            addFieldOfKind(entry.x, entry.y, int(entry.z), p, d, last == entry.x, errorBound, ahead);
        }
    }
}
