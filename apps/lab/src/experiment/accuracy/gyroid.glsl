// A gyroid as a user would write it: the value alone, without its gradient. The walls are 0.4 m thick.
float field(vec3 p) {
    vec3 q = 1.25 * p;
    float g = sin(q.x) * cos(q.y) + sin(q.y) * cos(q.z) + sin(q.z) * cos(q.x);
    return (abs(g) - 0.25) / 1.25;
}
