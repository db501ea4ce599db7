// The final pass: what each wave that reached the listener gives to the left and the
// right, from where it arrived relative to the listener's direction (thesis, 3.2.3).
//
// The side of an arrival is the component along the right ear of the unit vector from
// the listener's centre to the arrival point: -1 left, 0 ahead, behind, above, 1 right.
// A wave gives (1 - side) / 2 to the left and (1 + side) / 2 to the right.

uniform highp sampler2D uOrigins;
uniform highp sampler2D uDirections;
uniform vec4 uListener;        // centre in metres, in the march's coordinates; radius
uniform vec3 uListenerRight;   // unit vector out of the right ear

layout(location = 0) out vec4 outContribution;   // left, right, status, counters

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(uOrigins, texel, 0);
    float counters = texelFetch(uDirections, texel, 0).w;
    if (!reachedListener(origin.w)) {
        outContribution = vec4(0.0, 0.0, origin.w, counters);
        return;
    }
    vec3 offset = origin.xyz - uListener.xyz;
    float distance = length(offset);
    // A source at the very centre of the listener arrives from nowhere: the middle.
    float side = distance > 0.0 ? clamp(dot(offset, uListenerRight) / distance, -1.0, 1.0) : 0.0;
    outContribution = vec4(0.5 - 0.5 * side, 0.5 + 0.5 * side, origin.w, counters);
}
