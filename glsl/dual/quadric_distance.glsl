// Its gradient, from that of the function and the form times that.
vec4 quadricGradient(float value, vec3 gradient, vec3 formGradient, float norm) {
    float g = length(gradient);
    float off = quadricDistance(value, g, norm);
    vec3 growth = gradient - off * 2.0 * formGradient / max(g, 1e-30);
    return vec4(growth / max(2.0 * norm * abs(off) + g, 1e-30), off);
}
