// A counter-based integer hash (the PCG3D mixing of Jarzynski and Olano, "Hash Functions for GPU
// Rendering", JCGT 9(3), 2020): random numbers without state.
uvec3 mixBits(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// The upper 24 bits as a multiple of 2^-24 in [0, 1): exact in a float. (A division may be
// inexact.)
float unitInterval(uint bits) {
    return float(bits >> 8u) * 5.9604644775390625e-8;
}
