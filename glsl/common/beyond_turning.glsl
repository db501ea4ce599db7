// Distance bound beyond the greatest radius of a twist or a bend, from the value at that radius and
// the distance beyond it.
float beyondTurning(float value, float beyond, float lipschitz) {
    return beyond > 0.0 ? length(vec2(max(value, 0.0), lipschitz * beyond)) : value;
}
