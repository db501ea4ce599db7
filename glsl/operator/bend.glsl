// The point rotated backwards about z by `rate` radians per metre of x, so that a shape evaluated there is
// bent right-handedly. The point is clamped to the radius `most`.
vec3 bend(vec3 p, float rate, float most, out float beyond) {
    float radius = length(p.xy);
    beyond = max(radius - most, 0.0);
    vec2 held = beyond > 0.0 ? p.xy * (most / radius) : p.xy;
    vec2 turn = cosineSine(rate * held.x);
    return vec3(turn.x * held.x + turn.y * held.y, turn.x * held.y - turn.y * held.x, p.z);
}

// The gradient in the outer axes, from the gradient g at the rotated point q.
vec4 unbend(vec4 g, vec3 p, vec3 q, float rate, float beyond, float lipschitz) {
    float radius = length(p.xy);
    float kept = beyond > 0.0 ? 1.0 - beyond / radius : 1.0;
    vec2 turn = cosineSine(rate * p.x * kept);
    float turning = rate * (q.y * g.x - q.x * g.y);
    vec4 held = vec4(turn.x * g.x - turn.y * g.y + turning, turn.y * g.x + turn.x * g.y, g.z, g.w);
    if (beyond > 0.0) {
        // The clamped point varies around the axis and along it, but not with the radius.
        vec2 outward = p.xy / radius;
        float value = max(g.w, 0.0);
        float far = beyondTurning(g.w, beyond, lipschitz);
        held.xy = kept * (held.xy - dot(held.xy, outward) * outward);
        vec3 way = lipschitz * lipschitz * beyond * vec3(outward, 0.0);
        return vec4((value * held.xyz + way) / far, far);
    }
    return held;
}
