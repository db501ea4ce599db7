// A hyperboloid about y: diagonal . p^2 + constant.

float sdHyperboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    return centredQuadricDistance(p, diagonal, constant, norm);
}

vec4 gdHyperboloid(vec3 p, vec3 diagonal, float constant, float norm) {
    return centredQuadricGradient(p, diagonal, constant, norm);
}

float hitHyperboloid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    return centredQuadricHit(p, d, sign, diagonal, constant);
}
