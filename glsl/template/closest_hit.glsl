// Returns the distance from p along d to the first object hit, and its number. The wave that leaves
// a convex surface (last) cannot hit it again. Without a hit before limit the distance is limit,
// and the number is meaningless; if a step limit left the first hit undecided, the distance is
// GIVEN_UP.
float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {
    float nearest = @first@;
    object = 0.0;
@surfaces@
    return @result@;
}

