// Start directions: a spherical Fibonacci lattice, rotated as a whole by the seed.
//
// Heights advance in equal steps, azimuths by the golden ratio (Swinbank and Purser 2006; Hannay and Nye
// 2004): each wave represents the same share of the sphere, and neighbouring directions keep apart. The
// azimuth is computed modulo 1 in integers, so that it is as exact for the 16-millionth wave as for the
// first; in floats the azimuths would collapse onto a few values. The rotation is drawn uniformly from all
// rotations, so that each single direction is uniform over the sphere.

const uint GOLDEN_RATIO = 2654435769u;   // 2^32 times 0.6180339887

uniform vec4 uTurn;   // unit quaternion, imaginary part first

vec3 startDirection(uint wave, uint seed) {
    vec2 azimuth = cosineSineOfTurn(unitInterval(wave * GOLDEN_RATIO));
    // Counted from the nearer pole, so that the half in wave + 0.5 is never rounded away.
    uint rank = min(wave, uWaveCount - 1u - wave);
    float share = (float(rank) + 0.5) / float(uWaveCount);
    float ring = 2.0 * sqrt(share * (1.0 - share));
    float height = rank == wave ? 1.0 - 2.0 * share : 2.0 * share - 1.0;
    vec3 direction = vec3(ring * azimuth.x, height, ring * azimuth.y);
    return normalize(turn(uTurn, direction));
}
