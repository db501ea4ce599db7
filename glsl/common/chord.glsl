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
