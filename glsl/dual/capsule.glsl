vec4 gdCapsule(vec3 p, float radius, float halfHeight) {
    p.y -= clamp(p.y, -halfHeight, halfHeight);
    float apart = length(p);
    return vec4(p / max(apart, 1e-30), apart - radius);
}
