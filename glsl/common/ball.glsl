// Where a ray from outside meets a ball about the origin. The discriminant is taken from the
// distance of the centre to the line, which does not cancel (Haines et al., Ray Tracing
// Gems, ch. 7).
float hitBall(vec3 p, vec3 d, float squaredRadius) {
    float along = dot(p, d);
    vec3 aside = p - along * d;
    float under = squaredRadius - dot(aside, aside);
    float t = max(-along - sqrt(max(under, 0.0)), 0.0);
    return along < 0.0 && under > 0.0 ? t : NO_HIT;
}
