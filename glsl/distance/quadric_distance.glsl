// A lower bound of the distance to the surface where a quadratic function vanishes, from its
// value, the length g of its gradient and the norm of its form: |value| <= g r + norm r^2,
// solved for r. It agrees with the distance to first order at the surface.
float quadricDistance(float value, float g, float norm) {
    return 2.0 * value / max(g + sqrt(g * g + 4.0 * norm * abs(value)), 1e-30);
}
