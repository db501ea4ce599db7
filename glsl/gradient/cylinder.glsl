vec3 gradientCylinder(vec3 p) {
    vec2 outward = normalize(p.xz);
    return vec3(outward.x, 0.0, outward.y);
}
