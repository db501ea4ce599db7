// The contributions to the left and right ear of a wave that reached the listener, from its arrival
// point relative to the listener's direction (thesis, 3.2.3).
//
// The side of an arrival is the component along uListenerRight of the unit vector from the
// listener's centre to the arrival point: -1 left, 1 right, 0 ahead, behind or above. A wave
// contributes (1 - side) / 2 to the left and (1 + side) / 2 to the right.

uniform vec3 uListenerRight;   // unit vector out of the right ear

// The status of a wave whose position or direction is not finite; used only in contributions.
const float STATUS_NOT_FINITE = -2.0;

// Limits beyond which a squared position (metres²) or direction is invalid too: no scene is that large,
// and a direction's length is 1. Comparisons with NaN are false.
const float MOST_SQUARED_PLACE = 1e30;
const float MOST_SQUARED_DIRECTION = 2.0;

// Whether a wave's position, status and direction are finite and within these limits.
bool isFinite(vec4 origin, vec3 direction) {
    return dot(origin, origin) < MOST_SQUARED_PLACE && dot(direction, direction) < MOST_SQUARED_DIRECTION;
}

// Left, right, status, counters. The listener's centre is in the march's coordinates.
vec4 contribution(vec4 origin, vec4 direction, vec3 listenerCentre) {
    vec3 offset = origin.xyz - listenerCentre;
    float distance = length(offset);
    // A wave at the exact centre of the listener has no side and counts as in the middle.
    float side = distance > 0.0 ? clamp(dot(offset, uListenerRight) / distance, -1.0, 1.0) : 0.0;
    vec2 shares = reachedListener(origin.w) ? 0.5 + vec2(-0.5, 0.5) * side : vec2(0.0);
    vec4 told = vec4(shares, origin.w, direction.w);
    return isFinite(origin, direction.xyz) ? told : vec4(0.0, 0.0, STATUS_NOT_FINITE, 0.0);
}
