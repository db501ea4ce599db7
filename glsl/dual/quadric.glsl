vec4 gdQuadric(vec3 p, vec3 diagonal, vec3 mixed, vec3 linear, float constant, float norm) {
    vec3 form = quadricForm(p, diagonal, mixed);
    vec3 gradient = 2.0 * form + linear;
    vec3 bend = quadricForm(gradient, diagonal, mixed);
    return quadricGradient(dot(p, form + linear) + constant, gradient, bend, norm);
}
