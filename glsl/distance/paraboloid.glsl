// A paraboloid that opens towards +y: diagonal . p^2 - y. A bound of the distance, exact to
// first order.
float sdParaboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    vec3 gradient = 2.0 * form - vec3(0.0, 1.0, 0.0);
    return quadricDistance(dot(p, form) - p.y, length(gradient), norm);
}
