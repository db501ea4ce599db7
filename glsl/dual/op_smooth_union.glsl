vec4 opSmoothUnion(vec4 a, vec4 b, float radius) {
    float blend = max(radius - abs(a.w - b.w), 0.0);
    float share = 0.5 * blend / radius;
    vec3 gradient = a.w < b.w ? mix(a.xyz, b.xyz, share) : mix(b.xyz, a.xyz, share);
    return vec4(gradient, min(a.w, b.w) - 0.25 * blend * blend / radius);
}
