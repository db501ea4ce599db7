// Finds the chords of a line, where the rounding error of p is errorBound.
void findChords(vec3 p, vec3 d, float errorBound) {
@chords@
}

// The distance that a wave is free after its start, as the chords show: 0 if they show none. The rounding error of the
// start is errorBound.
float freeAtStart(float last, float errorBound) {
    float free = NO_END;
@at_start@
    return free;
}

// Returns what is ahead of p, which is t metres along the line, in the direction d; the rounding error of p is
// errorBound. A convex field that the wave leaves (last) cannot be hit.
Ahead fieldsAhead(float t, vec3 p, vec3 d, float last, float errorBound) {
    Ahead ahead = nothingAhead();
@surfaces@
    return ahead;
}
