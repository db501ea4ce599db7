// The order of starts (src/tracer/start_order.rs): neighbouring texels hold waves that start in neighbouring
// directions.

// Each texel: number of the wave that starts there; then the texel of the wave whose number is that of this texel.
uniform highp sampler2D uOrder;

uint waveAt(ivec2 texel) {
    return uint(texelFetch(uOrder, texel, 0).x);
}

// The texel of the wave that starts at `texel` if waves start in the order of their numbers.
ivec2 texelOfWave(ivec2 texel) {
    return ivec2(texelFetch(uOrder, texel, 0).yz);
}
