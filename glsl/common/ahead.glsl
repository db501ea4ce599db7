// What a march knows of the marched fields at a point of its line.

struct Ahead {
    vec4 nearest;      // value, slope, bend and reach of the nearest field on the line (bound.glsl)
    float object;      // the number of this field, or -1
    float errorBound;  // rounding error of its value, metres
    float free;        // distance along the line that is free of this field, metres
    float others;      // distance along the line that is free of all other fields, metres
    float cell;        // distance along the line to the end of the cell that lists these fields, metres
    float within;      // distance along the line that certainly stays in this cell, metres
};

// The slope of a field of which only the value is known.
const float UNKNOWN = 2.0;

Ahead nothingAhead() {
    return Ahead(vec4(1e30, 1.0, 0.0, 0.0), -1.0, 0.0, NO_END, NO_END, NO_END, NO_END);
}

// The distance that is free of a field, of which the line is known to be free for `known` metres.
float freeOf(vec4 field, float known) {
    float shown = field.y < UNKNOWN ? freeAlong(field, NO_END) : 0.0;
    return max(max(field.x, known), shown);
}

void addField(inout Ahead ahead, float object, vec4 field, float free, float errorBound) {
    bool isNearest = field.x < ahead.nearest.x;
    ahead.others = min(ahead.others, isNearest ? ahead.free : free);
    ahead.free = isNearest ? free : ahead.free;
    ahead.nearest = isNearest ? field : ahead.nearest;
    ahead.object = isNearest ? object : ahead.object;
    ahead.errorBound = isNearest ? errorBound : ahead.errorBound;
}
