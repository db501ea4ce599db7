vec4 gdParaboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    vec3 gradient = 2.0 * form - vec3(0.0, 1.0, 0.0);
    return quadricGradient(dot(p, form) - p.y, gradient, diagonal * gradient, norm);
}
