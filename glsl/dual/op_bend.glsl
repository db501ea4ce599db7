// The gradient in the outer axes, from that at the turned point q.
vec4 unbend(vec4 g, vec3 p, vec3 q, float rate, float beyond, float lipschitz) {
    if (beyond > 0.0) {
        vec2 outward = lipschitz * normalize(p.xy);
        return vec4(outward, 0.0, beyondTurning(g.w, beyond, lipschitz));
    }
    float s = sin(rate * p.x);
    float c = cos(rate * p.x);
    float turning = rate * (q.x * g.y - q.y * g.x);
    return vec4(c * g.x + s * g.y + turning, c * g.y - s * g.x, g.z, g.w);
}
