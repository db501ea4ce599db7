// Signed distance to a solid endless cylinder about the y axis. Exact.
float sdCylinder(vec3 p, float radius) {
    return length(p.xz) - radius;
}
