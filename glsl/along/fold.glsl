// How far a folded coordinate q, which moves by d a metre, goes on before the fold at 0.
float foldReach(float q, float d) {
    return d < 0.0 ? max(-q / d, 0.0) : NO_END;
}

// Which way a coordinate q that is folded at 0 goes on.
float foldSide(float q, float d) {
    return q < 0.0 || (q == 0.0 && d < 0.0) ? -1.0 : 1.0;
}

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

// How far a coordinate q goes on in the cell of its copy; the first and the last have no end.
float copyReach(float q, float d, float period, float first, float last) {
    float own = clamp(floor(q / period + 0.5), first, last);
    if (d == 0.0 || (d > 0.0 ? own == last : own == first)) {
        return NO_END;
    }
    return max(((own + (d > 0.0 ? 0.5 : -0.5)) * period - q) / d, 0.0);
}
