// Replaces counters.glsl in a frame that counts evaluations of the distance.
float evaluations = 0.0;
float countPass(float counters, bool zeroLength, bool limitReached) {
    return counters;
}
#define COUNT_EVALUATIONS(n) (evaluations += (n))
#define COUNTS_EVALUATIONS
