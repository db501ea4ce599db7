vec3 gradientPlane(vec3 p) {
    return vec3(0.0, 1.0, 0.0);
}
