vec4 gdRoundedBox(vec3 p, vec3 core, float rounding) {
    return vec4(gradientBox(p, core), sdRoundedBox(p, core, rounding));
}
