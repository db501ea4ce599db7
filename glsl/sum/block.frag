// A pass of a sum on the GPU: each texel adds up a block of the texels that `addTexel` reads.

uniform int uBlock;                       // side of a block in texels

layout(location = 0) out vec4 outHeard;   // left, right, waves at the listener, dead waves
layout(location = 1) out vec4 outPasses;  // of zero length, step limit reached; evaluations; waves not finite

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * uBlock;
    ivec2 end = min(first + uBlock, summandSize());
    vec4 heard = vec4(0.0);
    vec4 passes = vec4(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            addTexel(ivec2(x, y), heard, passes);
        }
    }
    outHeard = heard;
    outPasses = passes;
}
