float hitSphere(vec3 p, vec3 d, float radius) {
    return hitBall(p, d, radius);
}
