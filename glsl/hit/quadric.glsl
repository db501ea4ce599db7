// Where a ray from the air (the complement's for sign -1) meets any quadric.
float hitQuadric(vec3 p, vec3 d, float sign, vec3 diagonal, vec3 mixed, vec3 linear, float constant) {
    vec3 form = diagonal * p + mixed.zxy * p.yzx + mixed.yzx * p.zxy;
    vec3 bend = diagonal * d + mixed.zxy * d.yzx + mixed.yzx * d.zxy;
    float a = dot(d, bend);
    float b = dot(d, form + 0.5 * linear);
    float c = dot(p, form + linear) + constant;
    return fallingRoot(sign * a, sign * b, sign * c);
}
