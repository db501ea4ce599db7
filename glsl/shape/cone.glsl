// A finite cone about y.

// A cone about y with its base at -halfHeight and its tip at halfHeight. Exact. Returns the vector
// from the nearest point of the side or the base, in the half plane through the axis.
vec2 fromCone(vec2 q, float radius, float halfHeight, out float side) {
    vec2 rim = vec2(radius, -halfHeight);
    vec2 fromSide = fromSegment(q, vec2(0.0, halfHeight), rim);
    vec2 fromBase = fromSegment(q, vec2(0.0, -halfHeight), rim);
    bool inside = dot(vec2(2.0 * halfHeight, radius), q - rim) < 0.0 && q.y > -halfHeight;
    side = inside ? -1.0 : 1.0;
    return dot(fromSide, fromSide) < dot(fromBase, fromBase) ? fromSide : fromBase;
}

float sdCone(vec3 p, float radius, float halfHeight) {
    float side;
    vec2 q = fromCone(vec2(length(p.xz), p.y), radius, halfHeight, side);
    return side * length(q);
}

// The normal is constant within each region of the half plane, so that rounding near the surface cannot
// tilt it; the direction from the nearest point is used only beyond the tip and the rim.
vec4 gdCone(vec3 p, float radius, float halfHeight) {
    float side;
    float apart = length(p.xz);
    vec2 q = vec2(apart, p.y);
    float off = length(fromCone(q, radius, halfHeight, side));
    vec2 slant = normalize(vec2(2.0 * halfHeight, radius));
    vec2 fromRim = q - vec2(radius, -halfHeight);
    float beyondSide = dot(slant, fromRim);
    float below = -fromRim.y;
    vec2 fromTip = q - vec2(0.0, halfHeight);
    vec2 upwards = vec2(-slant.y, slant.x);
    vec2 normal = slant;
    if (beyondSide <= 0.0 && below <= 0.0) {
        normal = beyondSide > below ? slant : vec2(0.0, -1.0);
    } else if (below > 0.0 && fromRim.x <= 0.0) {
        normal = vec2(0.0, -1.0);
    } else if (dot(upwards, fromRim) < 0.0) {
        normal = fromRim / max(length(fromRim), 1e-30);
    } else if (dot(upwards, fromTip) > 0.0) {
        normal = fromTip / max(length(fromTip), 1e-30);
    }
    vec2 outward = normal.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, normal.y, outward.y, side * off);
}

// Hit of a ray with a finite cone about y: its side is the part of a quadric between tip and base, its base
// a disc.
float hitCone(vec3 p, vec3 d, float radius, float halfHeight, float errorBound) {
    float nearest = NO_HIT;
    float below = -halfHeight - p.y;
    if (d.y > 0.0 && below >= -errorBound) {
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
    // A wave that leaves the base starts inside the side's cone and does not enter it.
    float beyond = length(p.xz) + slope * tip;
    if (b < 0.0 && beyond < -2.0 * errorBound * (1.0 + slope)) {
        return nearest;
    }
    float t = rootFrom(way, root, c, b);
    float y = p.y + t * d.y;
    return t < nearest && abs(y) <= halfHeight ? t : nearest;
}

// The line leaves by the side where slope * (distance down from the tip) = distance from the axis.
float exitCone(vec3 p, vec3 d, float radius, float halfHeight) {
    float slope = radius / (2.0 * halfHeight);
    float down = slope * (halfHeight - p.y);
    float fall = -slope * d.y;
    float a = dot(d.xz, d.xz) - fall * fall;
    float b = dot(p.xz, d.xz) - down * fall;
    float c = dot(p.xz, p.xz) - down * down;
    float side = a < 0.0 && b <= 0.0 ? NO_END : exitRoot(a, b, c);
    return d.y < 0.0 ? min(side, (p.y + halfHeight) / -d.y) : side;
}
