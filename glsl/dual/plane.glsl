vec4 gdPlane(vec3 p) {
    return vec4(0.0, 1.0, 0.0, p.y);
}
