// Speed of a coordinate q, itself moving at speed d, after the interval from -by to by is cut out.
float cutSpeed(float q, float d, float by) {
    return by == 0.0 || abs(q) > by || (abs(q) == by && q * d > 0.0) ? d : 0.0;
}

// Distance over which this speed holds, to an end of the interval.
float cutReach(float q, float d, float by) {
    float side = d < 0.0 ? -by : by;
    float toFar = (side - q) / d;
    float toNear = (-side - q) / d;
    return d == 0.0 || by == 0.0 ? NO_END : toNear > 0.0 ? toNear : toFar > 0.0 ? toFar : NO_END;
}
