// Where a ray from outside meets a ball about the origin. The discriminant is taken from the
// distance of the centre to the line, which does not cancel (Haines et al., Ray Tracing
// Gems, ch. 7).
float hitBall(vec3 p, vec3 d, float radius) {
    float along = dot(p, d);
    vec3 aside = p - along * d;
    float under = radius * radius - dot(aside, aside);
    if (along >= 0.0 || under <= 0.0) {
        return NO_HIT;
    }
    return max(-along - sqrt(under), 0.0);
}
