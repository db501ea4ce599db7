// Traversal of the cells of one kind (docs/architecture.md, src/shader/scene_data.rs), in a single
// loop from record to record. CELL_VECTOR and CELL_AXES are the vector type and the components of the
// axes along which cells have ends.

// Maximum rounding error of the entry into a box, as a share of a cell: a quarter of the margin of the lists.
const float WITHIN_PAD = 2.5e-4;

// The object where a march of one surface has reached its step limit.
const float UNDECIDED = -1.0;

// The line of a surface that is marched alone, in the surface's own axes, from `lineStart` metres on.
float lineStart = 0.0;
vec3 lineFrom = vec3(0.0);
vec3 lineAlong = vec3(0.0);

int fieldSteps = 0;   // evaluations left for the marches of single surfaces in this flight

// A line through a grid (Amanatides and Woo 1987). The line crosses face n of an axis at n *
// between + offset metres: unlike a running sum, a product does not drift.
struct GridLine {
    CELL_VECTOR offset;
    CELL_VECTOR between;
    CELL_VECTOR ahead;   // 1 where the direction is positive: the next face of a cell is its upper one; else 0
    CELL_VECTOR onward;  // 1 where the direction is positive, else -1
    CELL_VECTOR place;   // the first cell
    float enters;        // metres along the line at which it enters and leaves the region of the cells
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

// Returns the cell beyond the face that the line crosses next. Each call advances along at least one axis,
// however a driver rounds equal distances.
CELL_VECTOR nextCell(CELL_VECTOR place, GridLine line, CELL_VECTOR faces) {
    return place + line.onward * atLeast(faces);
}
