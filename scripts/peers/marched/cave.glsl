// The distance of examples/scenes/cave.ron, with Echomarch's values where they shape the fillets.
float ellipsoid(vec3 p, vec3 radii) {
    vec3 g = p / (radii * radii);
    float F = dot(p, g) - 1.0;
    float slope = 2.0 * length(g);
    float least = min(radii.x, min(radii.y, radii.z));
    return 2.0 * F / (slope + sqrt(slope * slope + 4.0 * abs(F) / (least * least)));
}

float smoothUnion(float a, float b) {
    float h = max(2.0 - abs(a - b), 0.0);
    return min(a, b) - 0.125 * h * h;
}

float cone(vec3 p, float radius, float halfHeight) {
    vec2 q = vec2(length(p.xz) - radius, p.y + halfHeight);
    vec2 side = vec2(-radius, 2.0 * halfHeight);
    vec2 fromSide = q - side * clamp(dot(q, side) / dot(side, side), 0.0, 1.0);
    vec2 fromBase = vec2(max(q.x, 0.0), q.y);
    float d = sqrt(min(dot(fromSide, fromSide), dot(fromBase, fromBase)));
    return q.y > 0.0 && q.x * side.y - q.y * side.x < 0.0 ? -d : d;
}

float map(vec3 p) {
    vec3 q = p;
    q.x -= clamp(q.x, -6.0, 6.0);
    float air = ellipsoid(p - vec3(-7.0, 0.0, 0.0), vec3(5.5, 4.0, 5.0));
    air = smoothUnion(air, length(p - vec3(6.0, 0.5, -3.0)) - 4.0);
    air = smoothUnion(air, length(p - vec3(9.0, 0.0, 1.0)) - 2.5);
    air = smoothUnion(air, length(q) - 1.8);
    vec3 hanging = p - vec3(-8.0, 2.2, 1.5);
    float stones = cone(p - vec3(-5.0, -2.2, -2.0), 0.9, 2.0);
    stones = min(stones, cone(vec3(hanging.x, -hanging.y, hanging.z), 0.7, 2.0));
    stones = min(stones, ellipsoid(p - vec3(5.0, -2.7, -4.0), vec3(1.0, 0.7, 0.8)));
    return min(-air, stones);
}
