// Where a ray from the air (inside for sign -1) meets diagonal . p^2 - y = 0.
float hitParaboloid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    vec3 form = diagonal * p;
    float a = dot(d, diagonal * d);
    float b = dot(d, form) - 0.5 * d.y;
    float c = dot(p, form) - p.y;
    return fallingRoot(sign * a, sign * b, sign * c);
}
