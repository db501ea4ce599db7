// The nearest of the surfaces that can be nearest in the cell of p. Outside of the grid: the
// distance to what holds all of them, which is never less than the grid's border.
void distanceInCells(vec3 p, inout float nearest, inout float object) {
    vec3 place;
    if (!cellOf(p, place)) {
        float outside = length(max(max(uCellsMin - p, p - uCellsMax), 0.0));
        if (outside < nearest) { nearest = outside; object = 1.0; }
        return;
    }
    vec4 cell = cellAt(place);
    for (int i = 0; i < int(cell.y); ++i) {
        vec4 entry = listed(cell, i);
        float candidate = surfaceOfKind(entry.y, int(entry.z), p);
        if (candidate < nearest) { nearest = candidate; object = entry.x; }
    }
}
