vec4 gdSphere(vec3 p, float radius) {
    float apart = length(p);
    return vec4(p / max(apart, 1e-30), apart - radius);
}
