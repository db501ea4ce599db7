// Cosine and sine with the same accuracy on every driver: GLSL leaves the accuracy of its own
// functions open.
//
// Within an eighth of a turn on either side of 0 they are the polynomials of Cephes (Moshier 1989,
// sinf.c and cosf.c), which are correct to one rounding there; other angles are reduced by quarter
// turns.

// Cosine and sine of `quarters` quarter turns plus `angle` radians, at most an eighth of a turn.
vec2 cosineSineNear(int quarters, float angle) {
    float z = angle * angle;
    float sine = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * angle + angle;
    float cosine = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z
        - 0.5 * z + 1.0;
    vec2 turned = (quarters & 1) != 0 ? vec2(-sine, cosine) : vec2(cosine, sine);
    return (quarters & 2) != 0 ? -turned : turned;
}

// Cosine and sine of an angle given as a share of a turn, 0 to 1. Subtracting the quarters is
// exact.
vec2 cosineSineOfTurn(float share) {
    const float TWO_PI = 6.28318530718;
    float quarters = floor(4.0 * share + 0.5);
    return cosineSineNear(int(quarters), TWO_PI * (share - 0.25 * quarters));
}

// Cosine and sine of an angle in radians. Each quarter turn is subtracted in three parts, the first two with
// so few bits that their multiples are exact (Cody and Waite 1980). The result is correct to a few roundings
// of the angle up to 16384 quarters; beyond, rounding destroys the direction, but the length stays 1.
vec2 cosineSine(float angle) {
    const float MOST_LEFT = 0.8;   // an eighth of a turn, 0.785, plus roundings
    const float QUARTERS_A_RADIAN = 0.6366197723675814;
    const float FIRST = 1.5703125;
    const float SECOND = 4.837512969970703e-4;
    const float THIRD = 7.54978995489188e-8;
    float quarters = floor(QUARTERS_A_RADIAN * angle + 0.5);
    float left = ((angle - quarters * FIRST) - quarters * SECOND) - quarters * THIRD;
    return cosineSineNear(int(quarters), clamp(left, -MOST_LEFT, MOST_LEFT));
}
