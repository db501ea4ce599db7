// Where a ray from outside meets a solid box: the slab method (Kay and Kajiya 1986).
// A point that rounding put into the box is on the nearer face of the two along the line:
// on its way in it meets the box at once, on its way out not at all. A chord shorter than
// the slack is rounding too, not a box.
float hitBox(vec3 p, vec3 d, vec3 halfSize) {
    vec3 inverse = safeInverse(d);
    vec3 middle = -p * inverse;
    vec3 reach = halfSize * abs(inverse);
    vec3 enters = middle - reach;
    vec3 leaves = middle + reach;
    float enter = max(enters.x, max(enters.y, enters.z));
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    float ahead = max(enter, 0.0);
    return leave > ahead + uSlack && leave + enter > 0.0 ? ahead : NO_HIT;
}
