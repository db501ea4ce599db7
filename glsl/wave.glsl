// Layout of a sound wave in the texture pair (thesis, figure 7).
//   first texture:  origin x, y, z in metres, status
//   second texture: direction x, y, z, counters
// The thesis leaves the last component of the direction unused (0). Here it counts, only for reports, the
// passes of zero length and the marches that reached the step limit: counters = zeroLengthPasses + 4096 *
// limitsReached, exact below 2^24.

const float STATUS_DEAD = -1.0;     // dead: not followed further, and not heard
const float STATUS_LISTENER = 0.0;  // reached the listener
const float STATUS_STARTED = 0.5;   // not yet marched; n from 1 up: hit surface n
const float ZERO_LENGTH_PASS = 1.0;
const float LIMIT_REACHED = 4096.0;

uniform uint uWaveCount;   // waves in the texture pair; texels beyond are empty
uniform uint uGridWidth;   // texels in a row

uint waveIndex() {
    uvec2 texel = uvec2(gl_FragCoord.xy);
    return texel.y * uGridWidth + texel.x;
}

// The comparison of figure 8: a status is a float, and is compared with 0 within a margin.
bool reachedListener(float status) {
    return status > -0.1 && status < 0.1;
}
