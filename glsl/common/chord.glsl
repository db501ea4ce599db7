// Clips a chord to the slab between -halfHeight and halfHeight; if the line misses the slab, the chord
// is empty (leave < enter).
void clipToSlab(float y, float d, float halfHeight, inout float enter, inout float leave) {
    if (abs(d) > 1e-12) {
        float middle = -y / d;
        float reach = halfHeight / abs(d);
        enter = max(enter, middle - reach);
        leave = min(leave, middle + reach);
    } else if (abs(y) >= halfHeight) {
        leave = -NO_HIT;
    }
}

// Returns the hit of a convex solid from the distances at which the ray enters and leaves it. The exit must
// lie ahead by more than rounding, and further ahead than the entry lies behind: a start that rounding put
// inside the solid may be on its way in or out.
float hitChord(float enter, float leave, float errorBound) {
    float ahead = max(enter, 0.0);
    return leave > ahead + errorBound + ROUNDING * ahead && leave + enter > 0.0 ? ahead : NO_HIT;
}

// A chord: the distances along a line at which it enters and leaves a convex solid, in metres; without a chord the first
// exceeds the second.
const vec2 NO_CHORD = vec2(1e20, -1e20);

// The chord where the distance from the line's middle, whose square is (half of the chord)^2, is positive.
vec2 chordAbout(float middle, float squaredHalf) {
    float halfChord = sqrt(max(squaredHalf, 0.0));
    return squaredHalf > 0.0 ? vec2(middle - halfChord, middle + halfChord) : NO_CHORD;
}

// The chord of the least convex solid that contains two solids.
vec2 hullOfChords(vec2 a, vec2 b) {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

// The chord of the side of a plane towards which `beyond`, which grows by `speed` per metre, is negative.
vec2 chordBehindPlane(float beyond, float speed) {
    float crossing = -beyond / (abs(speed) > 1e-12 ? speed : 1e-12);
    vec2 parallel = beyond < 0.0 ? vec2(-1e20, 1e20) : NO_CHORD;
    return abs(speed) <= 1e-12 ? parallel : speed > 0.0 ? vec2(-1e20, crossing) : vec2(crossing, 1e20);
}
