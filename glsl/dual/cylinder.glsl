vec4 gdCylinder(vec3 p, float radius) {
    float apart = length(p.xz);
    vec2 outward = p.xz / max(apart, 1e-30);
    return vec4(outward.x, 0.0, outward.y, apart - radius);
}
