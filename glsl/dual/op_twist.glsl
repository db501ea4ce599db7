// The gradient in the outer axes, from that at the turned point q.
vec4 untwist(vec4 g, vec3 p, vec3 q, float rate, float beyond, float lipschitz) {
    if (beyond > 0.0) {
        vec2 outward = lipschitz * normalize(p.xz);
        return vec4(outward.x, 0.0, outward.y, beyondTurning(g.w, beyond, lipschitz));
    }
    float s = sin(rate * p.y);
    float c = cos(rate * p.y);
    return vec4(c * g.x + s * g.z, g.y + rate * (q.x * g.z - q.z * g.x), c * g.z - s * g.x, g.w);
}
