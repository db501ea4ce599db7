vec4 gdEllipsoid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    return quadricGradient(dot(p, form) + constant, 2.0 * form, 2.0 * diagonal * form, norm);
}
