// A box with rounded edges: the distance to its core, less the rounding. Exact.
float sdRoundedBox(vec3 p, vec3 core, float rounding) {
    return sdBox(p, core) - rounding;
}
