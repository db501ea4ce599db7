// Start directions: uniform over the sphere, one for each wave and seed.
//
// A counter-based hash (common/hash.glsl) gives each wave its own numbers without any state, so
// that they depend on wave and seed alone.

const float TWO_PI = 6.28318530718;

// Archimedes: the height is uniform, and so is the angle about the axis.
vec3 startDirection(uint wave, uint seed) {
    uvec3 bits = mixBits(uvec3(wave, seed, 0u));
    float height = 1.0 - 2.0 * unitInterval(bits.x);
    float angle = TWO_PI * unitInterval(bits.y);
    float ring = sqrt(max(0.0, 1.0 - height * height));
    return vec3(ring * cos(angle), height, ring * sin(angle));
}
