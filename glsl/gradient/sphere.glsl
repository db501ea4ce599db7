vec3 gradientSphere(vec3 p) {
    return normalize(p);
}
