// Clips a chord to the slab between -halfHeight and halfHeight; where the line misses the slab the chord
// ends before it begins.
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

// A convex solid is met where the ray enters it, if the ray leaves it later and the exit is further ahead than
// the entry is behind: a point that rounding put inside is either on its way in or on its way out.
float hitChord(float enter, float leave, float errorBound) {
    float ahead = max(enter, 0.0);
    return leave > ahead + errorBound + ROUNDING * ahead && leave + enter > 0.0 ? ahead : NO_HIT;
}
