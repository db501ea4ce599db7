// What a wave that reached the listener gives to the left and the right, from where it arrived
// relative to the listener's direction (thesis, 3.2.3).
//
// The side of an arrival is the component along the right ear of the unit vector from
// the listener's centre to the arrival point: -1 left, 0 ahead, behind, above, 1 right.
// A wave gives (1 - side) / 2 to the left and (1 + side) / 2 to the right.

uniform vec3 uListenerRight;   // unit vector out of the right ear

// Left, right, status, counters. The listener's centre is in the march's coordinates.
vec4 contribution(vec4 origin, float counters, vec3 listenerCentre) {
    vec3 offset = origin.xyz - listenerCentre;
    float distance = length(offset);
    // A source at the very centre of the listener arrives from nowhere: the middle.
    float side = distance > 0.0 ? clamp(dot(offset, uListenerRight) / distance, -1.0, 1.0) : 0.0;
    vec2 shares = reachedListener(origin.w) ? 0.5 + vec2(-0.5, 0.5) * side : vec2(0.0);
    return vec4(shares, origin.w, counters);
}
