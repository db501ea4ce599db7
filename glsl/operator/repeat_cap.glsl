// What the value of a repeated bound is held at, so that it does not jump where another copy is
// evaluated: near among the copies; beyond the box about all of them the way to it, divided by
// how slow the value may be.
float sdRepeatCap(vec3 p, vec3 halfSize, float near, float inverse) {
    vec3 beyond = abs(p) - halfSize;
    return max(near, inverse * max(beyond.x, max(beyond.y, beyond.z)));
}
