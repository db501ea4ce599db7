// Hilly ground: five octaves of value noise, as a user would write it.
float corner(vec2 cell) {
    uint bits = uint(int(cell.x) + 1024) * 374761393u + uint(int(cell.y) + 1024) * 668265263u;
    bits = (bits ^ (bits >> 13u)) * 1274126177u;
    return float(bits >> 22u) / 1023.0;
}

float noise(vec2 p) {
    vec2 cell = floor(p);
    vec2 f = p - cell;
    vec2 w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    float near = mix(corner(cell), corner(cell + vec2(1.0, 0.0)), w.x);
    float far = mix(corner(cell + vec2(0.0, 1.0)), corner(cell + vec2(1.0, 1.0)), w.x);
    return mix(near, far, w.y);
}

float field(vec3 p) {
    float height = 0.0;
    float amplitude = 1.2;
    vec2 q = 0.2 * p.xz;
    for (int octave = 0; octave < 5; ++octave) {
        height += amplitude * noise(q);
        amplitude *= 0.45;
        q = 2.0 * q + 7.0;
    }
    return p.y + 2.0 - height;
}
