// Further passes of a sum on the GPU: blocks of sums to one, until one texel is left.

uniform highp sampler2D uHeard;
uniform highp sampler2D uPasses;
uniform int uBlock;   // side of a block in texels

layout(location = 0) out vec4 outHeard;
layout(location = 1) out vec4 outPasses;

void main() {
    ivec2 size = textureSize(uHeard, 0);
    ivec2 first = ivec2(gl_FragCoord.xy) * uBlock;
    ivec2 end = min(first + uBlock, size);
    vec4 heard = vec4(0.0);
    vec4 passes = vec4(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            heard += texelFetch(uHeard, ivec2(x, y), 0);
            passes += texelFetch(uPasses, ivec2(x, y), 0);
        }
    }
    outHeard = heard;
    outPasses = passes;
}
