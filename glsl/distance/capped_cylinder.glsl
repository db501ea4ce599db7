// A cylinder about y that ends. Exact.
float sdCappedCylinder(vec3 p, float radius, float halfHeight) {
    return sdCorner(vec2(length(p.xz) - radius, abs(p.y) - halfHeight));
}
