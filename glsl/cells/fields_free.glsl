// Lowers `way` to the distance along d from p that is free of the marched fields in the cell of p.
void fieldsFreeInCells(vec3 p, vec3 d, float last, float errorBound, inout float way) {
    vec4 cell;
    float reach;
    float within;
    if (cellAhead(p, d, cell, reach, within)) {
        for (int i = 0; i < int(cell.y); ++i) {
            vec4 entry = listed(cell, i);
            float candidate = fieldOfKind(entry.y, int(entry.z), p, last == entry.x);
            if (candidate < way) {
                way = min(way, max(candidate, freeOfKind(entry.y, int(entry.z), p, d, errorBound)));
            }
        }
    }
    way = min(way, reach);
}
