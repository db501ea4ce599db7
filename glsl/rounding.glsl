// What rounding may do to a position, in metres: near the scene a few units in the last
// place of its largest coordinate, far from it of the position's own.
uniform float uSlack;

float roundingAt(vec3 p) {
    const float FEW_UNITS = 4.7683716e-7;   // 4 * 2^-23
    vec3 far = abs(p);
    return max(uSlack, FEW_UNITS * max(far.x, max(far.y, far.z)));
}
