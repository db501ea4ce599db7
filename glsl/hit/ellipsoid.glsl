// Where a ray from the air (inside for sign -1) meets diagonal . p^2 + constant = 0.
float hitEllipsoid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    float way = wayToOrigin(p, d);
    vec3 q = p + way * d;
    vec3 form = sign * diagonal * q;
    float a = sign * dot(d, diagonal * d);
    float root = fallingRoot(a, dot(d, form), dot(q, form) + sign * constant);
    vec3 start = sign * diagonal * p;
    return rootFrom(way, root, dot(p, start) + sign * constant, dot(d, start));
}
