// An ellipsoid: diagonal . p^2 + constant.

float sdEllipsoid(vec3 p, vec3 diagonal, float constant, float norm) {
    return centredQuadricDistance(p, diagonal, constant, norm);
}

vec4 gdEllipsoid(vec3 p, vec3 diagonal, float constant, float norm) {
    return centredQuadricGradient(p, diagonal, constant, norm);
}

float hitEllipsoid(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    return centredQuadricHit(p, d, sign, diagonal, constant);
}

vec2 chordEllipsoid(vec3 p, vec3 d, vec3 diagonal, float constant, float norm) {
    float a = dot(d, diagonal * d);
    float middle = -dot(p, diagonal * d) / a;
    vec3 nearest = p + middle * d;
    return chordAbout(middle, (-constant - dot(nearest, diagonal * nearest)) / a);
}
