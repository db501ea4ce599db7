// Distance to a ball that a wave along d can still meet: one that it recedes from is never met.
float sdSphereAhead(vec3 p, vec3 d, float radius) {
    const float NEVER = 1e30;
    return dot(p, d) >= 0.0 ? NEVER : length(p) - radius;
}
