// Any quadric: the form of diagonal and mixed numbers (yz, zx, xy), linear, constant. A bound
// of the distance, exact to first order.
vec3 quadricForm(vec3 p, vec3 diagonal, vec3 mixed) {
    return diagonal * p + mixed.zxy * p.yzx + mixed.yzx * p.zxy;
}

float sdQuadric(vec3 p, vec3 diagonal, vec3 mixed, vec3 linear, float constant, float norm) {
    vec3 form = quadricForm(p, diagonal, mixed);
    return quadricDistance(dot(p, form + linear) + constant, length(2.0 * form + linear), norm);
}
