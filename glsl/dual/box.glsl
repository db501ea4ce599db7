vec4 gdBox(vec3 p, vec3 halfSize) {
    return vec4(gradientBox(p, halfSize), sdBox(p, halfSize));
}
