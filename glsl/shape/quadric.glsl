// A general quadric.

// A general quadric: with diagonal, mixed (yz, zx, xy), linear and constant coefficients. A bound
// of the distance, exact to first order.
vec3 quadricForm(vec3 p, vec3 diagonal, vec3 mixed) {
    return diagonal * p + mixed.zxy * p.yzx + mixed.yzx * p.zxy;
}

float sdQuadric(vec3 p, vec3 diagonal, vec3 mixed, vec3 linear, float constant, float norm) {
    vec3 form = quadricForm(p, diagonal, mixed);
    return quadricDistance(dot(p, form + linear) + constant, length(2.0 * form + linear), norm);
}

vec4 gdQuadric(vec3 p, vec3 diagonal, vec3 mixed, vec3 linear, float constant, float norm) {
    vec3 form = quadricForm(p, diagonal, mixed);
    vec3 gradient = 2.0 * form + linear;
    vec3 bend = quadricForm(gradient, diagonal, mixed);
    return quadricGradient(dot(p, form + linear) + constant, gradient, bend, norm);
}

// Hit of a ray from the air (the complement's for sign -1) with a general quadric.
float hitQuadric(vec3 p, vec3 d, float sign, vec3 diagonal, vec3 mixed, vec3 linear, float constant) {
    float way = wayToOrigin(p, d);
    vec3 q = p + way * d;
    vec3 form = diagonal * q + mixed.zxy * q.yzx + mixed.yzx * q.zxy;
    vec3 bend = diagonal * d + mixed.zxy * d.yzx + mixed.yzx * d.zxy;
    float a = sign * dot(d, bend);
    float b = sign * dot(d, form + 0.5 * linear);
    float root = fallingRoot(a, b, sign * (dot(q, form + linear) + constant));
    vec3 start = diagonal * p + mixed.zxy * p.yzx + mixed.yzx * p.zxy;
    float value = sign * (dot(p, start + linear) + constant);
    return rootFrom(way, root, value, sign * dot(d, start + 0.5 * linear));
}
