// What a pass adds to a wave's counters.
float countPass(float counters, bool zeroLength, bool guardHit) {
    return counters + (zeroLength ? ZERO_LENGTH_PASS : 0.0) + (guardHit ? GUARD_HIT : 0.0);
}
#define COUNT_EVALUATIONS(n)
