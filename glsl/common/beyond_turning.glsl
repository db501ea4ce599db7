// Beyond the greatest radius of what a twist or a bend turns: the value at that radius, and
// the way there.
float beyondTurning(float value, float beyond, float lipschitz) {
    return beyond > 0.0 ? length(vec2(max(value, 0.0), lipschitz * beyond)) : value;
}
