// Finds the line's nearest hit with @label@, if it is nearer than `nearest`.
void closestOfKind@kind@(vec3 p, vec3 d, float last, inout float nearest, inout float object) {
    vec4 origin = uGrids[@grid@];
    vec4 size = uGrids[@grid@ + 1];
    CELL_VECTOR strides = uGrids[@grid@ + 4].CELL_AXES;
    int turns = int(uGrids[@grid@ + 4].w);   // more records than any line visits
    int first = int(origin.w);
    int most = int(size.w);
    vec3 inverse = safeInverse(d);
    GridLine line = gridLine(p.CELL_AXES, d.CELL_AXES, inverse.CELL_AXES, origin.CELL_AXES, size.CELL_AXES,
        uGrids[@grid@ + 2].CELL_AXES, uGrids[@grid@ + 3].CELL_AXES);
@of_line@
    CELL_VECTOR place = line.place;
    float t = line.enters;
    float known = min(nearest, line.leaves);
    float end = known;
    int listed = 0;   // the next record of a cell's list, or 0
    for (; turns > 0 && t < end; --turns) {
        int at = listed > 0 ? listed : first + @vectors@ * clamp(int(dot(place, strides)), 0, most);
        float tag = sceneData(at).@tag@;
        float number = abs(tag);
        int data = @data@;
        float candidate = @candidate@;
        bool isNearer = number > 0.0@is_left@ && candidate < end;
        end = isNearer ? candidate : end;
        object = isNearer ? number : object;
        listed = tag < 0.0 ? at + @vectors@ : number > 0.0 ? 0 : int(sceneData(at).x);
        CELL_VECTOR faces = (place + line.ahead) * line.between + line.offset;
        float next = least(faces);
        t = listed > 0 ? t : next;
        place = listed > 0 ? place : nextCell(place, line, faces);
    }
    nearest = end < known ? end : nearest;
}

