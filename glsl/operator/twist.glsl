// The point turned back about y by rate radians a metre of y, so that what it is asked of is
// turned right-handedly; held at the greatest radius.
vec3 twist(vec3 p, float rate, float most, out float beyond) {
    float radius = length(p.xz);
    beyond = max(radius - most, 0.0);
    vec2 held = beyond > 0.0 ? p.xz * (most / radius) : p.xz;
    float s = sin(rate * p.y);
    float c = cos(rate * p.y);
    return vec3(c * held.x - s * held.y, p.y, s * held.x + c * held.y);
}
