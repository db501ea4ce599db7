// The marched fields at a point of a march's line.

struct Ahead {
    OnLine nearest;    // the nearest field on the line
    float object;      // the number of this field, or -1
    float errorBound;  // rounding error of its value, metres
    float free;        // distance along the line that is free of this field, metres
    float others;      // distance along the line that is free of all other fields, metres
    float cell;        // distance along the line to the end of the cell that lists these fields, metres
    float within;      // distance along the line that certainly stays in this cell, metres
};

Ahead nothingAhead() {
    return Ahead(OnLine(1e30, 1.0, 0.0, 0.0, 0.0), -1.0, 0.0, NO_END, NO_END, NO_END, NO_END);
}

// The distance that is free of a field, of which the line is known to be free for `known` metres.
float freeOf(OnLine field, float known) {
    float shown = field.slope < UNKNOWN ? freeOnLine(field) : 0.0;
    return max(max(field.value, known), shown);
}

void addField(inout Ahead ahead, float object, OnLine field, float free, float errorBound) {
    bool isNearest = field.value < ahead.nearest.value;
    ahead.others = min(ahead.others, isNearest ? ahead.free : free);
    ahead.free = isNearest ? free : ahead.free;
    if (isNearest) {
        ahead.nearest = field;
    }
    ahead.object = isNearest ? object : ahead.object;
    ahead.errorBound = isNearest ? errorBound : ahead.errorBound;
}
