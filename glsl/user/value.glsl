// The user's field 0, cut off at its box and never evaluated beyond it. A value that is not a number, or -infinity,
// counts as solid: the checks allow it deep in the solid, where a relaxed step of a march may end.
float sdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float inside = user0_field(clamp(p, -halfSize, halfSize)) * inverseLipschitz;
    float deepest = -4.0 * largest(halfSize);   // beyond every value whose surface is in the box
    inside = inside > deepest ? inside : deepest;
    return max(inside, sdBox(p, halfSize));
}
