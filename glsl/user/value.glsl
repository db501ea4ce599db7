// The user's field 0, cut off at its box and never evaluated beyond it.
float sdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float inside = user0_field(clamp(p, -halfSize, halfSize)) * inverseLipschitz;
    return max(inside, sdBox(p, halfSize));
}
