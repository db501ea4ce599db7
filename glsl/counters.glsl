// Adds the counts of a pass to a wave's counters.
float countPass(float counters, bool zeroLength, bool limitReached) {
    return counters + (zeroLength ? ZERO_LENGTH_PASS : 0.0) + (limitReached ? LIMIT_REACHED : 0.0);
}
#define COUNT_EVALUATIONS(n)
