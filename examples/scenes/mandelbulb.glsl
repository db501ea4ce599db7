// A Mandelbulb of power 8 with a radius of about 1.2 m. The value is an estimate of the distance,
// r log r / (2 r'). Here r is the radius of the escaped point, and r' is its derivative by the point.

const int TURNS = 3;
const float POWER = 8.0;
const float ESCAPED = 4.0;      // larger values reduce the steps where the number of turns changes
const float DEEPEST = -0.05;    // metres

float field(vec3 p) {
    vec3 z = p;
    float r = length(z);
    float derivative = 1.0;
    for (int turn = 0; turn < TURNS && r < ESCAPED; ++turn) {
        // At the origin and on the axis the angles are undefined, and any angle is valid.
        float safe = max(r, 1e-6);
        float tilt = POWER * acos(clamp(z.y / safe, -1.0, 1.0));
        float turned = POWER * atan(z.z, abs(z.x) + abs(z.z) > 0.0 ? z.x : 1.0);
        float grown = pow(safe, POWER - 1.0);
        derivative = POWER * grown * derivative + 1.0;
        vec3 way = vec3(sin(tilt) * cos(turned), cos(tilt), sin(tilt) * sin(turned));
        z = grown * safe * way + p;
        r = length(z);
    }
    float distance = 0.5 * log(max(r, 1e-6)) * r / derivative;
    return max(distance, DEEPEST);
}
