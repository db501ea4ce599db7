// Signed distance to a solid box about the origin. Exact on both sides.
float sdBox(vec3 p, vec3 halfSize) {
    vec3 beyond = abs(p) - halfSize;
    return length(max(beyond, 0.0)) + min(max(beyond.x, max(beyond.y, beyond.z)), 0.0);
}
