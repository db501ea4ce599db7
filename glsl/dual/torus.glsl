vec4 gdTorus(vec3 p, float ring, float tube) {
    float apart = length(p.xz);
    vec2 q = vec2(apart - ring, p.y);
    float off = length(q);
    q /= max(off, 1e-30);
    vec2 outward = q.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, q.y, outward.y, off - tube);
}
