// How far a folded coordinate q, which moves by d a metre, goes on before the fold at 0.
float foldReach(float q, float d) {
    return d < 0.0 ? max(-q / d, 0.0) : NO_END;
}

// Which way a coordinate q that is folded at 0 goes on.
float foldSide(float q, float d) {
    return q < 0.0 || (q == 0.0 && d < 0.0) ? -1.0 : 1.0;
}
