// Signed distance to a solid ball about the origin. Exact.
float sdSphere(vec3 p, float radius) {
    return length(p) - radius;
}
