// Puts a point that is met onto the ball, and says the normal there.
void landSphere(inout vec3 p, float radius, out vec3 normal) {
    normal = normalize(p);
    p = normal * radius;
}
