// Puts a point that is met onto the plane, and says the normal there.
void landPlane(inout vec3 p, out vec3 normal) {
    p.y = 0.0;
    normal = vec3(0.0, 1.0, 0.0);
}
