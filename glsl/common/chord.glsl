// A convex solid is met where the ray enters it, if it leaves it later and further ahead than
// behind: a point that rounding put into it is on its way in, or on its way out.
float hitChord(float enter, float leave, float errorBound) {
    float ahead = max(enter, 0.0);
    return leave > ahead + errorBound + ROUNDING * ahead && leave + enter > 0.0 ? ahead : NO_HIT;
}
