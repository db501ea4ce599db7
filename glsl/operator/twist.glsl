// The point rotated backwards about y by `rate` radians per metre of y, so that a shape evaluated there is
// twisted right-handedly. The point is clamped to the radius `most`.
vec3 twist(vec3 p, float rate, float most, out float beyond) {
    float radius = length(p.xz);
    beyond = max(radius - most, 0.0);
    vec2 held = beyond > 0.0 ? p.xz * (most / radius) : p.xz;
    vec2 turn = cosineSine(rate * p.y);
    return vec3(turn.x * held.x - turn.y * held.y, p.y, turn.y * held.x + turn.x * held.y);
}

// The gradient in the outer axes, from the gradient g at the rotated point q.
vec4 untwist(vec4 g, vec3 p, vec3 q, float rate, float beyond, float lipschitz) {
    vec2 turn = cosineSine(rate * p.y);
    float turning = rate * (q.x * g.z - q.z * g.x);
    vec4 held = vec4(turn.x * g.x + turn.y * g.z, g.y + turning, turn.x * g.z - turn.y * g.x, g.w);
    if (beyond > 0.0) {
        // The clamped point varies around the axis and along it, but not with the radius.
        float radius = length(p.xz);
        vec2 outward = p.xz / radius;
        float value = max(g.w, 0.0);
        float far = beyondTurning(g.w, beyond, lipschitz);
        float kept = 1.0 - beyond / radius;
        held.xz = kept * (held.xz - dot(held.xz, outward) * outward);
        vec3 way = lipschitz * lipschitz * beyond * vec3(outward.x, 0.0, outward.y);
        return vec4((value * held.xyz + way) / far, far);
    }
    return held;
}
