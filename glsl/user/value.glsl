// The user's value as it is written, or a number deep in the solid if it is none or -infinity: the checks allow
// that deep in the solid, where a relaxed step of a march or a wide difference may end.
float numberOfUser0(vec3 p) {
    const float DEEP = -1e12;   // its quotients by lengths have finite squares
    float value = user0_field(p);
    return value > DEEP ? value : DEEP;
}

// The user's field 0, cut off at its box and never evaluated beyond it.
float sdUser0(vec3 p, vec3 halfSize, float inverseLipschitz) {
    float inside = numberOfUser0(clamp(p, -halfSize, halfSize)) * inverseLipschitz;
    return max(inside, sdBox(p, halfSize));
}
