// What is left of the speed d of a coordinate q that is cut out between -by and by.
float cutSpeed(float q, float d, float by) {
    return by == 0.0 || abs(q) > by || (abs(q) == by && q * d > 0.0) ? d : 0.0;
}

// How far that goes on before the border of what is cut out.
float cutReach(float q, float d, float by) {
    float side = d < 0.0 ? -by : by;
    float toFar = (side - q) / d;
    float toNear = (-side - q) / d;
    return d == 0.0 || by == 0.0 ? NO_END : toNear > 0.0 ? toNear : toFar > 0.0 ? toFar : NO_END;
}
