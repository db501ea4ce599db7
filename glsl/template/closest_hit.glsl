// How far from p along d the next object is, and its number. A convex surface is
// not met by the wave that leaves it (last). Where nothing is met before limit the
// distance is limit and the number means nothing; it is GIVEN_UP where a step limit
// left open what comes first.
float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {
    float nearest = @first@;
    object = 0.0;
@surfaces@
    return nearest;
}

