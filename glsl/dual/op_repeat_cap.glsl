vec4 gdRepeatCap(vec3 p, vec3 halfSize, float near, float inverse) {
    vec3 beyond = abs(p) - halfSize;
    float most = max(beyond.x, max(beyond.y, beyond.z));
    if (near >= inverse * most) {
        return vec4(0.0, 0.0, 0.0, near);
    }
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    vec3 axis = most == beyond.x ? vec3(1.0, 0.0, 0.0)
        : most == beyond.y ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
    return inverse * vec4(side * axis, most);
}
