// A wall along a gyroid, a surface that divides space into two labyrinths.

const float SCALE = 1.3;    // per metre
const float WALL = 0.35;    // half the wall's thickness, in units of the gyroid's value

float field(vec3 p) {
    vec3 q = SCALE * p;
    float gyroid = dot(sin(q), cos(q.yzx));
    return (abs(gyroid) - WALL) / SCALE;
}
