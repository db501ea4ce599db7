// The vector p rotated by the unit quaternion q (imaginary part first).
vec3 turn(vec4 q, vec3 p) {
    return p + 2.0 * cross(q.xyz, cross(q.xyz, p) + q.w * p);
}
