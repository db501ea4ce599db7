// Passages: parts of a wave's energy that continue through the solid that the wave meets
// (src/tracer/arrivals/passages.rs).

uniform vec2 uPassing;             // materials whose solids transmit: the number before the first, and the last number
uniform float uPassageShare;       // probability of a passage at a hit of such a material
uniform uint uPassageSeed;
uniform uint uIterationsBefore;    // iterations before the chunk

uint passingWave = 0u;

// The fraction that marks a record as a passage. The fraction of a crossing is at most a half.
const float PASSAGE = 0.75;

// Whether a part of the wave passes the solid of the material with this number, in this iteration of the chunk.
bool passes(float number, float iteration) {
    uvec3 bits = mixBits(uvec3(passingWave, uPassageSeed, uIterationsBefore + uint(iteration)));
    bool isTransmitting = number > uPassing.x && number <= uPassing.y;
    return isTransmitting && unitInterval(bits.x) < uPassageShare;
}
