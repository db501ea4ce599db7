// Input of the further passes of a sum on the GPU: the sums of blocks.

uniform highp sampler2D uHeard;
uniform highp sampler2D uPasses;

ivec2 summandSize() {
    return textureSize(uHeard, 0);
}

void addTexel(ivec2 texel, inout vec4 heard, inout vec4 passes) {
    heard += texelFetch(uHeard, texel, 0);
    passes += texelFetch(uPasses, texel, 0);
}
