// A paraboloid.

// A paraboloid that opens towards +y: diagonal . p^2 - y. A bound on the distance, exact to
// first order.
float sdParaboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    vec3 gradient = 2.0 * form - vec3(0.0, 1.0, 0.0);
    return quadricDistance(dot(p, form) - p.y, length(gradient), norm);
}

vec4 gdParaboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    vec3 gradient = 2.0 * form - vec3(0.0, 1.0, 0.0);
    return quadricGradient(dot(p, form) - p.y, gradient, diagonal * gradient, norm);
}

// Hit of a ray from the air (inside for sign -1) with diagonal . p^2 - y = 0.
float hitParaboloid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    float way = wayToOrigin(p, d);
    vec3 q = p + way * d;
    vec3 form = diagonal * q;
    float a = sign * dot(d, diagonal * d);
    float b = sign * (dot(d, form) - 0.5 * d.y);
    float root = fallingRoot(a, b, sign * (dot(q, form) - q.y));
    vec3 start = diagonal * p;
    return rootFrom(way, root, sign * (dot(p, start) - p.y), sign * (dot(d, start) - 0.5 * d.y));
}
