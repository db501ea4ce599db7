// Where a ray from outside meets the endless cylinder about y: the circle in the plane.
float hitCylinder(vec3 p, vec3 d, float radius) {
    float speed = length(d.xz);
    if (speed < 1e-12) {
        return NO_HIT;
    }
    vec2 heading = d.xz / speed;
    float along = dot(p.xz, heading);
    vec2 aside = p.xz - along * heading;
    float under = radius * radius - dot(aside, aside);
    if (along >= 0.0 || under <= 0.0) {
        return NO_HIT;
    }
    return max((-along - sqrt(under)) / speed, 0.0);
}
