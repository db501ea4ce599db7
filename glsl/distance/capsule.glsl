// A cylinder about y with round ends. Exact.
float sdCapsule(vec3 p, float radius, float halfHeight) {
    p.y -= clamp(p.y, -halfHeight, halfHeight);
    return length(p) - radius;
}
