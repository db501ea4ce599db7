// First pass of a sum on the GPU: each texel adds up a block of the panning texture.
// Counts are whole numbers in floats, exact up to 2^24 and rounded above.

uniform highp sampler2D uContributions;   // left, right, status, counters
uniform int uBlock;                       // side of a block in texels

layout(location = 0) out vec4 outHeard;   // left, right, waves at the listener, dead waves
layout(location = 1) out vec4 outPasses;  // of zero length, step limit reached; evaluations; waves not finite

void main() {
    ivec2 size = textureSize(uContributions, 0);
    ivec2 first = ivec2(gl_FragCoord.xy) * uBlock;
    ivec2 end = min(first + uBlock, size);
    vec4 heard = vec4(0.0);
    vec4 passes = vec4(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            if (uint(y) * uGridWidth + uint(x) >= uWaveCount) {
                continue;
            }
            vec4 wave = texelFetch(uContributions, ivec2(x, y), 0);
            float arrived = reachedListener(wave.z) ? 1.0 : 0.0;
            float broken = wave.z < -1.5 ? 1.0 : 0.0;
            heard += vec4(wave.xy, arrived, wave.z < -0.1 ? 1.0 - broken : 0.0);
            float limitsReached = floor(wave.w * (1.0 / LIMIT_REACHED));
            passes += vec4(wave.w - limitsReached * LIMIT_REACHED, limitsReached, wave.w, broken);
        }
    }
    outHeard = heard;
    outPasses = passes;
}
