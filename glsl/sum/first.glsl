// Input of the first pass of a sum on the GPU: the waves of the panning texture.
// Counts are whole numbers in floats, exact up to 2^24 and rounded above.

uniform highp sampler2D uContributions;   // left, right, status, counters

ivec2 summandSize() {
    return textureSize(uContributions, 0);
}

void addTexel(ivec2 texel, inout vec4 heard, inout vec4 passes) {
    if (uint(texel.y) * uGridWidth + uint(texel.x) >= uWaveCount) {
        return;
    }
    vec4 wave = texelFetch(uContributions, texel, 0);
    float arrived = reachedListener(wave.z) ? 1.0 : 0.0;
    float broken = wave.z < -1.5 ? 1.0 : 0.0;
    heard += vec4(wave.xy, arrived, wave.z < -0.1 ? 1.0 - broken : 0.0);
    float limitsReached = floor(wave.w * (1.0 / LIMIT_REACHED));
    passes += vec4(wave.w - limitsReached * LIMIT_REACHED, limitsReached, wave.w, broken);
}
