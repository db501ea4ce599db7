// Updates the nearest surface with those in the cell of p, and lowers `second` to the distance
// ahead within which no other surface can be hit.
void directedInCells(vec3 p, vec3 d, float last, inout float nearest, inout float object, inout float second) {
    vec4 cell;
    float reach;
    float within;
    if (cellAhead(p, d, cell, reach, within)) {
        for (int i = 0; i < int(cell.y); ++i) {
            vec4 entry = listed(cell, i);
            float candidate = distanceOfKind(entry.y, int(entry.z), p, d, last == entry.x);
            if (candidate < nearest) { second = nearest; nearest = candidate; object = entry.x; }
            else { second = min(second, candidate); }
        }
    }
    second = min(second, reach);
}
