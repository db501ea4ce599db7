// A bound on the distance at a point beyond the greatest radius of a twist or a bend, from the
// value at this radius and the point's distance `beyond` the radius.
float beyondTurning(float value, float beyond, float lipschitz) {
    return beyond > 0.0 ? length(vec2(max(value, 0.0), lipschitz * beyond)) : value;
}
