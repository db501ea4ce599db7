// Where a ray from outside meets a solid box: the slab method (Kay and Kajiya 1986).
// A point that rounding put into the box is on the face it would have entered by. A chord
// shorter than the slack is rounding too, not a box.
float hitBox(vec3 p, vec3 d, vec3 halfSize) {
    vec3 inverse = safeInverse(d);
    vec3 middle = -p * inverse;
    vec3 reach = halfSize * abs(inverse);
    vec3 enters = middle - reach;
    vec3 leaves = middle + reach;
    float enter = max(enters.x, max(enters.y, enters.z));
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    enter = max(enter, 0.0);
    return leave > enter + uSlack ? enter : NO_HIT;
}
