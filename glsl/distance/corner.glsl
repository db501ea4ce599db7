// The distance to a quarter plane, from the distances to its edges' lines; and what it takes
// of the gradients of the two.
float sdCorner(vec2 beyond) {
    return length(max(beyond, 0.0)) + min(max(beyond.x, beyond.y), 0.0);
}
