// Loads a surface of @label@, and finds the line from p along d in the surface's own axes, from `start`
// metres on.
void load@kind@(int data, vec3 p, vec3 d, float start) {
@load@
    lineStart = start;
    lineFrom = @start@;
    lineAlong = @along@;
}

// Returns the loaded surface on its line, t metres from p, as an Ahead; the rounding error of the point is errorBound.
Ahead ahead@kind@(float t, float errorBound) {
    vec3 q = lineFrom + (t - lineStart) * lineAlong;
    OnLine field = @field@;
    return Ahead(field, 1.0, @error_bound@, freeOf(field, @free@), NO_END, NO_END, NO_END);
}

// Finds the line's nearest hit with @label@, if it is nearer than `nearest`. Each surface whose box the line enters
// before the nearest hit is marched alone, in the cell in which the line enters the box. If a march reaches its step
// limit, the object is UNDECIDED from where the line enters the box.
void closestOfKind@kind@(vec3 p, vec3 d, float last, inout float nearest, inout float object) {
    vec4 origin = uGrids[@grid@];
    vec4 size = uGrids[@grid@ + 1];
    CELL_VECTOR strides = uGrids[@grid@ + 4].CELL_AXES;
    int turns = int(uGrids[@grid@ + 4].w);   // more records than any line visits
    int first = int(origin.w);
    int most = int(size.w);
    vec3 inverse = safeInverse(d);
    vec3 slowness = abs(inverse);
    GridLine line = gridLine(p.CELL_AXES, d.CELL_AXES, inverse.CELL_AXES, origin.CELL_AXES, size.CELL_AXES,
        uGrids[@grid@ + 2].CELL_AXES, uGrids[@grid@ + 3].CELL_AXES);
    CELL_VECTOR place = line.place;
    float t = line.enters;
    float known = min(nearest, line.leaves);
    float end = known;
    float errorBound = ROUNDING * largest(p);
    float early = WITHIN_PAD * least(size.CELL_AXES);
    int listed = 0;   // the next record of a cell's list, or 0
    while (turns > 0 && t < end) {
        float number = 0.0;
        int data = 0;
        vec3 centre = vec3(0.0);
        float margin = 0.0;
        float came = t;   // where the line enters the cell of the record
        bool isNear = false;
        for (; turns > 0 && t < end && !isNear; --turns) {
            int at = listed > 0 ? listed : first + @vectors@ * clamp(int(dot(place, strides)), 0, most);
            vec4 head = sceneData(at);
            vec4 around = sceneData(at + 1);
            data = at + @box_vectors@;
            number = abs(head.w);
            centre = head.xyz;
            margin = CHORD_MARGIN * max(errorBound, around.w);
            came = t;
            CELL_VECTOR faces = (place + line.ahead) * line.between + line.offset;
            float next = least(faces);
            // A line that enters the surface's box in this cell is, in this cell, in the box along the axes around it.
            vec3 middle = (centre - p) * inverse;
            vec3 reach = (around.xyz + margin) * slowness;
            float enters = greatest(middle - reach);
            float leaves = least(middle + reach);
            bool isAhead = enters <= leaves && leaves > 0.0 && enters < end;
            bool isHere = enters <= next + early && (t <= line.enters || leaves >= t - early);
            isNear = number > 0.0@is_left@ && isAhead && isHere;
            listed = head.w < 0.0 ? at + @vectors@ : number > 0.0 ? 0 : int(head.x);
            t = listed > 0 ? t : next;
            place = listed > 0 ? place : nextCell(place, line, faces);
        }
        vec2 chord = chordBox(@point@, @vector@, sceneData(data - 1).xyz + margin);
        bool isAhead = chord.x <= chord.y && chord.y > 0.0 && chord.x < end;
        bool isNew = came <= line.enters || chord.x >= came - early;
        bool isEntered = isNear && isAhead && isNew;
        float start = max(chord.x, 0.0);
        load@kind@(data, p, d, start);
        float found;
        bool limitReached;
        float candidate = march@kind@(p, d, start, isEntered ? min(chord.y, end) : 0.0, found, limitReached);
        bool isNearer = isEntered && (candidate >= 0.0 || limitReached);
        end = isNearer ? (limitReached ? start : candidate) : end;
        object = isNearer ? (limitReached ? UNDECIDED : number) : object;
    }
    nearest = end < known ? end : nearest;
}
