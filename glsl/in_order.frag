// The pass after a whole frame in one pass with sorted starts: puts the contributions of the waves in the order of their
// numbers.

uniform highp sampler2D uContributions;   // in the order of starts

layout(location = 0) out vec4 outContribution;   // left, right, status, counters

void main() {
    outContribution = texelFetch(uContributions, texelOfWave(ivec2(gl_FragCoord.xy)), 0);
}
