// Where a line leaves a convex solid that it begins in, in metres.
float exitBox(vec3 p, vec3 d, vec3 halfSize) {
    vec3 within = vec3(d.x < 0.0 ? p.x : -p.x, d.y < 0.0 ? p.y : -p.y, d.z < 0.0 ? p.z : -p.z) + halfSize;
    vec3 way = within / max(abs(d), 1e-30);
    return min(way.x, min(way.y, way.z));
}

// The greater root of a t^2 + 2 b t + c, whose a is not negative.
float exitRoot(float a, float b, float c) {
    float root = sqrt(max(b * b - a * c, 0.0));
    if (b > 0.0) {
        return -c / (b + root);
    }
    return a > 0.0 ? (root - b) / a : NO_END;
}

float exitBall(vec3 p, vec3 d, float radius) {
    return exitRoot(dot(d, d), dot(p, d), dot(p, p) - radius * radius);
}

float exitCylinder(vec3 p, vec3 d, float radius) {
    return exitRoot(dot(d.xz, d.xz), dot(p.xz, d.xz), dot(p.xz, p.xz) - radius * radius);
}

float exitSlab(float y, float d, float halfHeight) {
    return ((d < 0.0 ? y : -y) + halfHeight) / max(abs(d), 1e-30);
}

float exitCapsule(vec3 p, vec3 d, float radius, float halfHeight) {
    float side = exitCylinder(p, d, radius);
    float y = p.y + side * d.y;
    if (abs(y) <= halfHeight) {
        return side;
    }
    return exitBall(p - vec3(0.0, y < 0.0 ? -halfHeight : halfHeight, 0.0), d, radius);
}

// The side is met where slope * (way down from the tip) = distance from the axis.
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

float exitCappedCylinder(vec3 p, vec3 d, float radius, float halfHeight) {
    return min(exitCylinder(p, d, radius), exitSlab(p.y, d.y, halfHeight));
}

float exitEdge(vec2 p, vec2 d, vec2 from, vec2 to) {
    vec2 outward = normalize(vec2(to.y - from.y, from.x - to.x));
    float speed = dot(outward, d);
    return speed > 0.0 ? dot(outward, from - p) / speed : NO_END;
}

float exitPrism(vec3 p, vec3 d, vec2 a, vec2 b, vec2 c, float halfDepth) {
    float side = min(exitEdge(p.xy, d.xy, a, b), min(exitEdge(p.xy, d.xy, b, c), exitEdge(p.xy, d.xy, c, a)));
    return min(side, exitSlab(p.z, d.z, halfDepth));
}
