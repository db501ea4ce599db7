// Returns what is ahead of p along d, where the rounding error of p is errorBound. A convex field that the wave leaves
// (last) cannot be hit.
Ahead fieldsAhead(vec3 p, vec3 d, float last, float errorBound) {
    Ahead ahead = nothingAhead();
@surfaces@
    return ahead;
}
