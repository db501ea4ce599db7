// Distance to the plane if a wave along d can still meet it: one that it recedes from is never met.
float sdPlaneAhead(vec3 p, vec3 d) {
    const float NEVER = 1e30;
    return d.y >= 0.0 ? NEVER : p.y;
}
