vec4 gdHalfSpace(vec3 p, vec3 normal, float offset) {
    return vec4(normal, sdHalfSpace(p, normal, offset));
}
