// Hit of a ray from outside with a ball about the origin. The discriminant is computed from the
// distance of the centre to the line, which avoids cancellation (Haines et al., Ray Tracing
// Gems, ch. 7).
float hitBall(vec3 p, vec3 d, float squaredRadius) {
    float along = dot(p, d);
    vec3 aside = p - along * d;
    float under = squaredRadius - dot(aside, aside);
    float t = max(-along - sqrt(max(under, 0.0)), 0.0);
    return along < 0.0 && under > 0.0 ? t : NO_HIT;
}
