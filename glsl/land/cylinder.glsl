// Puts a point that is met onto the cylinder, and says the normal there.
void landCylinder(inout vec3 p, float radius, out vec3 normal) {
    vec2 outward = normalize(p.xz);
    normal = vec3(outward.x, 0.0, outward.y);
    p.xz = normal.xz * radius;
}
