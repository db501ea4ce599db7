// A cylinder about y with round ends.

// A cylinder about y with round ends. Exact.
float sdCapsule(vec3 p, float radius, float halfHeight) {
    p.y -= clamp(p.y, -halfHeight, halfHeight);
    return length(p) - radius;
}

vec4 gdCapsule(vec3 p, float radius, float halfHeight) {
    p.y -= clamp(p.y, -halfHeight, halfHeight);
    float apart = length(p);
    return vec4(p / max(apart, 1e-30), apart - radius);
}

// Hit of a ray with a cylinder about y with round ends: with its side or with the ball at either
// end.
float hitCapsule(vec3 p, vec3 d, float radius, float halfHeight, float errorBound) {
    float nearest = NO_HIT;
    float speed = length(d.xz);
    if (speed > 1e-12) {
        vec2 heading = d.xz / speed;
        float along = dot(p.xz, heading);
        vec2 aside = p.xz - along * heading;
        float under = radius * radius - dot(aside, aside);
        if (along < 0.0 && under > 0.0) {
            float t = (-along - sqrt(under)) / speed;
            if (t > -errorBound && abs(p.y + t * d.y) <= halfHeight) {
                nearest = max(t, 0.0);
            }
        }
    }
    vec3 up = vec3(0.0, halfHeight, 0.0);
    // From outside, the inner half of a ball is never hit before the side.
    return min(nearest, min(hitSphere(p - up, d, radius), hitSphere(p + up, d, radius)));
}

float exitCapsule(vec3 p, vec3 d, float radius, float halfHeight) {
    float side = exitCylinder(p, d, radius);
    float y = p.y + side * d.y;
    if (abs(y) <= halfHeight) {
        return side;
    }
    return exitSphere(p - vec3(0.0, y < 0.0 ? -halfHeight : halfHeight, 0.0), d, radius);
}

vec3 bendCapsule(vec4 gradient, vec3 p, float radius, float halfHeight) {
    return bendOfDistance(gradient.w + radius);
}

// The solid is the least convex one that contains a cylinder and two balls.
vec2 chordCapsule(vec3 p, vec3 d, float radius, float halfHeight) {
    vec3 up = vec3(0.0, halfHeight, 0.0);
    vec2 side = chordCappedCylinder(p, d, radius, halfHeight);
    vec2 balls = hullOfChords(chordSphere(p - up, d, radius), chordSphere(p + up, d, radius));
    return side.x < side.y ? hullOfChords(side, balls) : balls;
}
