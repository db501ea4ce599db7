// The nearest of the surfaces in cells that the line intersects, if it is nearer than what is known.
void hitInCells(vec3 p, vec3 d, float last, inout float nearest, inout float object) {
    vec3 inverse = safeInverse(d);
    vec2 span = throughGrid(p, inverse);
    if (!(span.x < span.y)) {
        return;
    }
    vec3 place = clamp(floor((p + span.x * d - uCellOrigin) / uCellSize), vec3(0.0), uCellCount - 1.0);
    vec3 step_ = vec3(inverse.x > 0.0 ? 1.0 : -1.0, inverse.y > 0.0 ? 1.0 : -1.0, inverse.z > 0.0 ? 1.0 : -1.0);
    float t = span.x;
    while (t < nearest) {
        vec4 cell = cellAt(place);
        for (int i = 0; i < int(cell.y); ++i) {
            vec4 entry = listed(cell, i);
            float candidate = hitOfKind(entry.y, int(entry.z), p, d, last == entry.x, nearest);
            if (candidate < nearest) { nearest = candidate; object = entry.x; }
        }
        vec3 faces = nextCrossings(p, inverse, place);
        t = min(faces.x, min(faces.y, faces.z));
        place += vec3(faces.x == t ? step_.x : 0.0, faces.y == t ? step_.y : 0.0, faces.z == t ? step_.z : 0.0);
        if (any(lessThan(place, vec3(0.0))) || any(greaterThanEqual(place, uCellCount))) {
            return;
        }
    }
}
