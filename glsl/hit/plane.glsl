// Where a ray from p along the unit vector d meets the plane y = 0 from above.
float hitPlane(vec3 p, vec3 d) {
    return d.y < 0.0 ? max(p.y / -d.y, 0.0) : NO_HIT;
}
