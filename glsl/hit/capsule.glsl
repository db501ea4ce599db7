// Where a ray meets a cylinder about y with round ends: the side between the ends, or a ball.
float hitCapsule(vec3 p, vec3 d, float radius, float halfHeight, float slack) {
    float nearest = NO_HIT;
    float speed = length(d.xz);
    if (speed > 1e-12) {
        vec2 heading = d.xz / speed;
        float along = dot(p.xz, heading);
        vec2 aside = p.xz - along * heading;
        float under = radius * radius - dot(aside, aside);
        if (along < 0.0 && under > 0.0) {
            float t = (-along - sqrt(under)) / speed;
            if (t > -slack && abs(p.y + t * d.y) <= halfHeight) {
                nearest = max(t, 0.0);
            }
        }
    }
    vec3 up = vec3(0.0, halfHeight, 0.0);
    // From outside the inner half of a ball is never met before the side.
    return min(nearest, min(hitBall(p - up, d, radius), hitBall(p + up, d, radius)));
}
