// The gyroid of gyroid.glsl, with its gradient stated.
float field(vec3 p) {
    vec3 q = 1.25 * p;
    vec3 s = sin(q);
    vec3 c = cos(q);
    return (abs(dot(s, c.yzx)) - 0.3) / 1.25;
}

vec3 fieldGradient(vec3 p) {
    vec3 q = 1.25 * p;
    vec3 s = sin(q);
    vec3 c = cos(q);
    return sign(dot(s, c.yzx)) * (c * c.yzx - s * s.zxy);
}
