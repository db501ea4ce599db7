// Traces a wave through `iterations` iterations, or until it has finished.
void traceIterations(int iterations, inout vec4 origin, inout vec4 direction) {
    for (int i = 0; i < iterations; ++i) {
        if (finished(origin.w)) {
            break;
        }
        iterate(origin, direction);
    }
#ifdef COUNTS_EVALUATIONS
    direction.w += evaluations;
#endif
}
