// Start directions: uniform over the sphere, one for each wave and seed.
//
// A counter-based integer hash (the PCG3D mixing of Jarzynski and Olano, "Hash
// Functions for GPU Rendering", JCGT 9(3), 2020) gives each wave its own numbers
// without any state, so that they depend on wave and seed alone.

const float TWO_PI = 6.28318530718;

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

// The upper 24 bits as a multiple of 2^-24 in [0, 1): exact in a float.
float unitInterval(uint bits) {
    return float(bits >> 8u) / 16777216.0;
}

// Archimedes: the height is uniform, and so is the angle about the axis.
vec3 startDirection(uint wave, uint seed) {
    uvec3 bits = mixBits(uvec3(wave, seed, 0u));
    float height = 1.0 - 2.0 * unitInterval(bits.x);
    float angle = TWO_PI * unitInterval(bits.y);
    float ring = sqrt(max(0.0, 1.0 - height * height));
    return vec3(ring * cos(angle), height, ring * sin(angle));
}
