// The final pass: the contribution of each wave to the left and the right.

uniform highp sampler2D uOrigins;
uniform highp sampler2D uDirections;
uniform vec4 uListener;   // centre in metres, in the march's coordinates; radius

layout(location = 0) out vec4 outContribution;   // left, right, status, counters

void main() {
    ivec2 texel = @texel@;
    vec4 origin = texelFetch(uOrigins, texel, 0);
    vec4 direction = texelFetch(uDirections, texel, 0);
    outContribution = contribution(origin, direction, uListener.xyz);
}
