// All passes of a frame in one: starts each wave, traces it through all iterations, and writes its
// contribution to the left and the right. If the caller does not read the waves themselves, no texture pair is
// written or
// read.

uniform int uIterationsInPass;

layout(location = 0) out vec4 outContribution;   // left, right, status, counters

void main() {
    copyUniforms();
    copySettings();
    uint wave = @wave@;
    vec4 origin;
    vec4 direction;
    startWave(wave, origin, direction);
    int iterations = wave < uWaveCount ? uIterationsInPass : 0;
    traceIterations(iterations, origin, direction);
    outContribution = contribution(origin, direction, uListener.xyz);
}
