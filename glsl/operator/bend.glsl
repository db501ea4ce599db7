// The point turned back about z by rate radians a metre of x, so that what it is asked of is
// turned right-handedly; held at the greatest radius.
vec3 bend(vec3 p, float rate, float most, out float beyond) {
    float radius = length(p.xy);
    beyond = max(radius - most, 0.0);
    vec2 held = beyond > 0.0 ? p.xy * (most / radius) : p.xy;
    float s = sin(rate * held.x);
    float c = cos(rate * held.x);
    return vec3(c * held.x + s * held.y, c * held.y - s * held.x, p.z);
}
