// A ring about y. Exact.
float sdTorus(vec3 p, float ring, float tube) {
    return length(vec2(length(p.xz) - ring, p.y)) - tube;
}
