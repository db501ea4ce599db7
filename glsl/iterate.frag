// A march pass: reads each wave, traces it through one iteration (as in the thesis) or several, and
// writes it to the other texture pair.

uniform highp sampler2D uOrigins;
uniform highp sampler2D uDirections;
uniform int uIterationsInPass;

layout(location = 0) out vec4 outOrigin;
layout(location = 1) out vec4 outDirection;

void main() {
    copyUniforms();
    copySettings();
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(uOrigins, texel, 0);
    vec4 direction = texelFetch(uDirections, texel, 0);
    int iterations = waveIndex() < uWaveCount ? uIterationsInPass : 0;
    traceIterations(iterations, origin, direction);
    outOrigin = origin;
    outDirection = direction;
}
