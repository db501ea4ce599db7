// Hills: value noise in five octaves. Each octave has half the width and 0.4 times the height of the
// previous octave.

const int OCTAVES = 5;

// A pseudo-random number from 0 to 1 for a lattice point. It is computed with integers, because the
// sine of a large number differs between renderers.
float lattice(vec2 at) {
    uint h = uint(int(at.x) + 4096) * 747796405u + uint(int(at.y) + 4096) * 2891336453u;
    h = ((h >> 15u) ^ h) * 277803737u;
    return float((h >> 12u) & 4095u) / 4095.0;
}

// The second derivative is continuous too, so that a bend can be stated.
float noise(vec2 p) {
    vec2 at = floor(p);
    vec2 f = p - at;
    f = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    float near = mix(lattice(at), lattice(at + vec2(1.0, 0.0)), f.x);
    float far = mix(lattice(at + vec2(0.0, 1.0)), lattice(at + vec2(1.0, 1.0)), f.x);
    return mix(near, far, f.y);
}

float field(vec3 p) {
    float height = 0.0;
    float most = 1.6;         // metres
    vec2 q = 0.25 * p.xz;     // the widest hills are 4 m apart
    for (int octave = 0; octave < OCTAVES; ++octave) {
        height += most * noise(q);
        most *= 0.4;
        q = 2.0 * q + 17.0;   // the lattice points of different octaves do not coincide
    }
    return p.y + 1.5 - height;
}
