// A hyperboloid about y: diagonal . p^2 + constant. A bound of the distance, exact to first order.
float sdHyperboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    return quadricDistance(dot(p, form) + constant, 2.0 * length(form), norm);
}
