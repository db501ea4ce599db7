// The distance to the ring's centre line bends by no less than -1 over the distance from the
// axis, and by no more than 1 over itself; both are known to half of these on.
vec4 alongTorus(vec4 gradient, vec3 p, vec3 d, float ring, float tube) {
    float fromAxis = length(p.xz);
    return vec4(gradient.w, dot(gradient.xyz, d), 2.0 / max(fromAxis, 1e-30), 0.5 * fromAxis);
}

vec4 alongTorusSolid(vec4 gradient, vec3 p, vec3 d, float ring, float tube) {
    float least = min(length(p.xz), gradient.w + tube);
    return vec4(-gradient.w, -dot(gradient.xyz, d), 2.0 / max(least, 1e-30), 0.5 * least);
}
