vec4 gdHeightField(vec3 p, vec3 halfSize, float inverseGrowth, int first, ivec2 size) {
    vec3 held = clamp(p, -halfSize, halfSize);
    vec3 ground = groundAt(held, halfSize, first, size);
    float above = (held.y - ground.z) * inverseGrowth;
    float outside = sdBox(p, halfSize);
    if (outside > above) {
        return vec4(gradientBox(p, halfSize), outside);
    }
    // Held at the box, the ground does not change beyond it.
    vec3 growth = vec3(-ground.x, 1.0, -ground.y) * step(abs(p), halfSize);
    return vec4(growth * inverseGrowth, above);
}
