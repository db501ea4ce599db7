// Where a line leaves a rounded box through a flat part of its faces; 0 for the rounded ones.
float exitRoundedBox(vec3 p, vec3 d, vec3 core, float rounding, float slack) {
    float way = exitBox(p, d, core + rounding);
    return sdRoundedBox(p + way * d, core, rounding) <= slack ? way : 0.0;
}
