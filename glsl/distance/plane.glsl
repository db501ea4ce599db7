// Signed distance to the plane y = 0: air above, solid below. Exact.
float sdPlane(vec3 p) {
    return p.y;
}
