// Distance over which a folded coordinate q, which changes by d per metre, stays on its side of the fold at
// 0.
float foldReach(float q, float d) {
    return d < 0.0 ? max(-q / d, 0.0) : NO_END;
}

// The side of the fold at 0 on which a coordinate q is or will be, as a sign.
float foldSide(float q, float d) {
    return q < 0.0 || (q == 0.0 && d < 0.0) ? -1.0 : 1.0;
}
