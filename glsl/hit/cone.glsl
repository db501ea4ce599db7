// Where a ray meets a cone about y that ends: its side is a quadric of which the part between
// tip and base counts, its base a disc.
float hitCone(vec3 p, vec3 d, float radius, float halfHeight, float slack) {
    float nearest = NO_HIT;
    float below = -halfHeight - p.y;
    if (d.y > 0.0 && below >= -slack) {
        float t = max(below, 0.0) / d.y;
        vec2 at = p.xz + t * d.xz;
        if (dot(at, at) <= radius * radius) {
            nearest = t;
        }
    }
    float slope = radius / (2.0 * halfHeight);
    float narrowing = slope * slope;
    float tip = p.y - halfHeight;
    float way = wayToOrigin(p, d);
    vec3 q = p + way * d;
    float aside = q.y - halfHeight;
    float a = dot(d.xz, d.xz) - narrowing * d.y * d.y;
    float root = fallingRoot(
        a,
        dot(q.xz, d.xz) - narrowing * aside * d.y,
        dot(q.xz, q.xz) - narrowing * aside * aside);
    float b = dot(p.xz, d.xz) - narrowing * tip * d.y;
    float c = dot(p.xz, p.xz) - narrowing * tip * tip;
    // A wave that leaves the base is inside of the side's cone, and not on its way into it.
    float beyond = length(p.xz) + slope * tip;
    if (b < 0.0 && beyond < -2.0 * slack * (1.0 + slope)) {
        return nearest;
    }
    float t = rootFrom(way, root, c, b);
    float y = p.y + t * d.y;
    return t < nearest && abs(y) <= halfHeight ? t : nearest;
}
