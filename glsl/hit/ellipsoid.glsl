// Where a ray from the air (inside for sign -1) meets diagonal . p^2 + constant = 0.
float hitEllipsoid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    vec3 form = sign * diagonal * p;
    return fallingRoot(sign * dot(d, diagonal * d), dot(d, form), dot(p, form) + sign * constant);
}
