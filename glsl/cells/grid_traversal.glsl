// Grid traversal (DDA; Amanatides and Woo 1987). The distances to the next faces are computed from
// the cell's indices each time, because running sums would drift.
vec3 nextCrossings(vec3 p, vec3 inverse, vec3 place) {
    vec3 ahead = vec3(inverse.x > 0.0 ? 1.0 : 0.0, inverse.y > 0.0 ? 1.0 : 0.0, inverse.z > 0.0 ? 1.0 : 0.0);
    return (uCellOrigin + (place + ahead) * uCellSize - p) * inverse;
}

// Returns the distance to the line's entry into the grid, the component of `over` for the entry face, and the
// distance to the exit.
vec3 throughGrid(vec3 p, vec3 inverse, vec3 over) {
    vec3 a = (uCellOrigin - p) * inverse;
    vec3 b = (uCellOrigin + uCellCount * uCellSize - p) * inverse;
    vec3 enters = min(a, b);
    vec3 leaves = max(a, b);
    // The entry face is the one that the line reaches last.
    float beyond = enters.x >= enters.y && enters.x >= enters.z ? over.x : enters.y >= enters.z ? over.y : over.z;
    return vec3(
        max(max(enters.x, max(enters.y, enters.z)), 0.0),
        beyond,
        min(leaves.x, min(leaves.y, leaves.z)));
}

// Distance that a step goes beyond a face, as a share of a cell: enough that even a line nearly parallel
// to the face has certainly crossed it, and half the margin with which the lists are built.
const float BEYOND = 5e-4;

// Returns whether p is in the grid, and its cell. `reach` is the distance along d to just beyond the end of the
// cell, or to the grid for a p outside. Up to the distance `within` along d the same list certainly applies.
bool cellAhead(vec3 p, vec3 d, out vec4 cell, out float reach, out float within) {
    vec3 inverse = safeInverse(d);
    vec3 over = BEYOND * uCellSize * abs(inverse);
    vec3 place;
    cell = vec4(0.0);
    if (!cellOf(p, place)) {
        vec3 span = throughGrid(p, inverse, over);
        float entered = span.x + span.y;
        bool isAhead = entered < span.z;
        reach = isAhead ? entered : 1e30;
        within = isAhead ? span.x - span.y : 1e30;
        return false;
    }
    vec3 faces = nextCrossings(p, inverse, place);
    vec3 beyond = faces + over;
    vec3 before = faces - over;
    reach = min(beyond.x, min(beyond.y, beyond.z));
    within = min(before.x, min(before.y, before.z));
    cell = cellAt(place);
    return true;
}
