// Lines through the cells of one kind (docs/architecture.md, src/kernel/record.rs): the text for a
// kind goes from record to record in one straight loop. CELL_VECTOR and CELL_AXES are of the axes
// along which cells have ends.

// A line through a grid (Amanatides and Woo 1987). The line crosses face n of an axis at
// n * between + offset metres: what is computed from a number does not drift as sums do.
struct GridLine {
    CELL_VECTOR offset;
    CELL_VECTOR between;
    CELL_VECTOR ahead;   // 1 where it goes up along the axis: the face ahead of a cell is the next one
    CELL_VECTOR onward;  // 1 where it goes up, else -1
    CELL_VECTOR place;   // of its first cell
    float enters;        // where it comes to what the cells hold, and leaves that
    float leaves;
};

GridLine gridLine(CELL_VECTOR p, CELL_VECTOR d, CELL_VECTOR inverse, CELL_VECTOR origin, CELL_VECTOR size, CELL_VECTOR low, CELL_VECTOR high) {
    GridLine line;
    line.offset = (origin - p) * inverse;
    line.between = size * inverse;
    line.ahead = step(CELL_VECTOR(0.0), inverse);
    line.onward = 2.0 * line.ahead - 1.0;
    CELL_VECTOR a = (low - p) * inverse;
    CELL_VECTOR b = (high - p) * inverse;
    line.enters = max(greatest(min(a, b)), 0.0);
    line.leaves = least(max(a, b));
    line.place = floor((p + line.enters * d - origin) / size);
    return line;
}

// The cell behind the faces that the line crosses next, at `next`.
CELL_VECTOR nextCell(CELL_VECTOR place, GridLine line, CELL_VECTOR faces, float next) {
    return place + mix(CELL_VECTOR(0.0), line.onward, lessThanEqual(faces, CELL_VECTOR(next)));
}

float least(float v) { return v; }
float least(vec2 v) { return min(v.x, v.y); }
float least(vec3 v) { return min(v.x, min(v.y, v.z)); }
float greatest(float v) { return v; }
float greatest(vec2 v) { return max(v.x, v.y); }
float greatest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// Where a line from outside meets an endless pillar whose axis is at -p in the plane. `heading` is
// the line's direction there, and `stretch` its length a metre in the plane.
float enterPillar(vec2 p, vec2 heading, float stretch, float radius) {
    float along = dot(p, heading);
    vec2 aside = p - along * heading;
    float under = radius * radius - dot(aside, aside);
    float t = max((-along - sqrt(max(under, 0.0))) * stretch, 0.0);
    return along < 0.0 && under > 0.0 ? t : NO_HIT;
}

// hitBox for a line whose direction was inverted before.
float enterBox(vec3 p, vec3 inverse, vec4 halfSizeAndErrorBound) {
    vec3 middle = -p * inverse;
    vec3 reach = halfSizeAndErrorBound.xyz * abs(inverse);
    float enter = greatest(middle - reach);
    float leave = least(middle + reach);
    float ahead = max(enter, 0.0);
    float errorBound = halfSizeAndErrorBound.w + ROUNDING * ahead;
    return leave > ahead + errorBound && leave + enter > 0.0 ? ahead : NO_HIT;
}
