// A Menger sponge of 4 m with three levels. A cross with a third of the cube's width is cut out of the
// cube, and likewise out of each of the 20 remaining cubes. The value is the maximum of the values of the
// cube and the crosses. It grows by at most 1 m per metre.

const float HALF_SIZE = 2.0;
const int LEVELS = 3;

// Depth inside the infinite cross of square bars from -1 to 1 along the axes.
float in_cross(vec3 p) {
    return 1.0 - min(max(p.x, p.y), min(max(p.y, p.z), max(p.z, p.x)));
}

float field(vec3 p) {
    vec3 q = p / HALF_SIZE;
    vec3 beyond = abs(q) - 1.0;
    float value = max(beyond.x, max(beyond.y, beyond.z));
    float scale = 1.0;
    for (int level = 0; level < LEVELS; level++) {
        // The position in its cube is from -1 to 1; 3.0 * in_cube is in half widths of the bars.
        vec3 in_cube = mod(q * scale + 1.0, 2.0) - 1.0;
        scale *= 3.0;
        value = max(value, in_cross(abs(3.0 * in_cube)) / scale);
    }
    return value * HALF_SIZE;
}
