// The coordinate q relative to the middle of a copy: the copy whose cell contains q, moved on by step_
// copies, and clamped to the copies first to last.
float repeatCopy(float q, float period, float first, float last, float step_) {
    float own = clamp(floor(q / period + 0.5), first, last);
    return q - period * clamp(own + step_, first, last);
}

// The direction from the middle of the cell of q to the nearer neighbouring cell.
float repeatSide(float q, float period, float first, float last) {
    return q >= period * clamp(floor(q / period + 0.5), first, last) ? 1.0 : -1.0;
}

// Upper limit of the value of a repeated bound, so that it does not jump where another copy is evaluated:
// `near` among the copies; outside the box around all of them, the distance to that box divided by the
// value's least growth.
float sdRepeatCap(vec3 p, vec3 halfSize, float near, float inverse) {
    vec3 beyond = abs(p) - halfSize;
    return max(near, inverse * max(beyond.x, max(beyond.y, beyond.z)));
}

vec4 gdRepeatCap(vec3 p, vec3 halfSize, float near, float inverse) {
    vec3 beyond = abs(p) - halfSize;
    float most = max(beyond.x, max(beyond.y, beyond.z));
    if (near >= inverse * most) {
        return vec4(0.0, 0.0, 0.0, near);
    }
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    vec3 axis = beyond.x >= beyond.y && beyond.x >= beyond.z ? vec3(1.0, 0.0, 0.0)
        : beyond.y >= beyond.z ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
    return inverse * vec4(side * axis, most);
}

// Distance over which a coordinate q stays in the cell of its copy; the first and last cells extend
// without end.
float copyReach(float q, float d, float period, float first, float last) {
    float own = clamp(floor(q / period + 0.5), first, last);
    if (d == 0.0 || (d > 0.0 ? own >= last : own <= first)) {
        return NO_END;
    }
    return max(((own + (d > 0.0 ? 0.5 : -0.5)) * period - q) / d, 0.0);
}

// Traversal of a line past repeated copies that do not overlap, each in a box about its middle.
//
// Theory. The usual traversal (Amanatides and Woo 1987) visits every cell on the line. This one goes from
// box to box: along each axis it keeps the next copy whose slab (the box's extent along this axis) the line
// has not left, and the distances at which the line enters and leaves this slab. Where the line is in the
// slabs of all three axes, it enters the box; otherwise every axis whose slab ends first advances to the
// copy at that point, however many copies lie between. So a line between two layers of copies reaches its
// next crossing of a layer in one turn.
//
// Along each axis, copy numbers and coordinates are mirrored where the line runs in the negative
// direction. Copy numbers are integers, exact in a float up to 2^24; boxes are enlarged by the possible
// rounding error of positions there, so that no box is missed.

struct CopyTraversal {
    vec3 side;      // 1, or -1 where the direction is negative
    vec3 start;     // start of the line, metres
    vec3 speed;     // metres along each axis per metre of the line
    vec3 inverse;   // 1 / speed
    vec3 period;    // from one copy to the next, metres; arbitrary along an axis without repetition
    vec3 front;     // where the line enters a copy's slab, relative to its middle
    vec3 back;      // where the line leaves the slab
    vec3 last;      // the number of the last copy
    float errorBound;    // possible rounding error of the start, metres
    vec3 copy;      // the next copy along each axis
    vec3 met;       // the copy whose box the line has entered, in numbers that are not mirrored
    float at;       // metres along the line to this box
    bool ended;     // whether all copies are behind
};

// Possible rounding errors of coordinates at `place`.
vec3 copyErrorBound(CopyTraversal traversal, vec3 place) {
    return traversal.errorBound + ROUNDING * (abs(traversal.start) + abs(place));
}

// For each axis, the first copy whose slab the line has not left after `way` metres.
vec3 copiesAhead(CopyTraversal traversal, float way) {
    vec3 place = traversal.start + way * traversal.speed;
    return ceil((place - traversal.back - copyErrorBound(traversal, place)) / traversal.period);
}

// The traversal of the line q + t d past the copies first to last, each in a box from least to most.
CopyTraversal traverseCopies(vec3 q, vec3 d, float errorBound, vec3 period, vec3 least, vec3 most, vec3 first, vec3 last) {
    CopyTraversal traversal;
    traversal.inverse = safeInverse(d);
    bvec3 up = greaterThan(traversal.inverse, vec3(0.0));
    traversal.side = vec3(up.x ? 1.0 : -1.0, up.y ? 1.0 : -1.0, up.z ? 1.0 : -1.0);
    traversal.start = traversal.side * q;
    traversal.speed = abs(d);
    traversal.inverse = abs(traversal.inverse);
    traversal.period = period;
    traversal.front = vec3(up.x ? least.x : -most.x, up.y ? least.y : -most.y, up.z ? least.z : -most.z);
    traversal.back = vec3(up.x ? most.x : -least.x, up.y ? most.y : -least.y, up.z ? most.z : -least.z);
    traversal.last = vec3(up.x ? last.x : -first.x, up.y ? last.y : -first.y, up.z ? last.z : -first.z);
    traversal.errorBound = errorBound;
    vec3 lowest = vec3(up.x ? first.x : -last.x, up.y ? first.y : -last.y, up.z ? first.z : -last.z);
    traversal.copy = max(lowest, copiesAhead(traversal, 0.0));
    traversal.met = vec3(0.0);
    traversal.at = 0.0;
    traversal.ended = false;
    return traversal;
}

// Advances to the next point at which the line may be in the slabs of all axes. Returns whether it
// enters the box of the copy traversal.met there.
bool comesIntoBox(inout CopyTraversal traversal, float limit) {
    vec3 middle = traversal.period * traversal.copy;
    vec3 errorBound = copyErrorBound(traversal, middle);
    vec3 enters = (middle + traversal.front - errorBound - traversal.start) * traversal.inverse;
    vec3 leaves = (middle + traversal.back + errorBound - traversal.start) * traversal.inverse;
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    traversal.at = max(max(enters.x, max(enters.y, enters.z)), 0.0);
    traversal.met = traversal.side * traversal.copy;
    traversal.ended = traversal.at >= limit || any(greaterThan(traversal.copy, traversal.last));
    float way = max(traversal.at, leave);
    vec3 next = max(traversal.copy + 1.0, copiesAhead(traversal, way));
    // At least one axis advances, however a driver rounds the comparison.
    bvec3 first = greaterThan(atLeast(leaves), vec3(0.0));
    bvec3 left = bvec3(first.x || leaves.x <= way, first.y || leaves.y <= way, first.z || leaves.z <= way);
    traversal.copy = vec3(left.x ? next.x : traversal.copy.x, left.y ? next.y : traversal.copy.y, left.z ? next.z : traversal.copy.z);
    return traversal.at <= leave && !traversal.ended;
}

// One turn of the traversal. Sets whether the line enters a box; returns false if no copies are left
// before limit. Most boxes are found within three tries, so that a loop takes few turns.
bool nextCopy(inout CopyTraversal traversal, float limit, out bool comes) {
    comes = comesIntoBox(traversal, limit);
    if (!comes && !traversal.ended) {
        comes = comesIntoBox(traversal, limit);
    }
    if (!comes && !traversal.ended) {
        comes = comesIntoBox(traversal, limit);
    }
    return !traversal.ended;
}

const int LEAPS = 4;   // maximum turns of a traversal of copies for a bound

// A distance over which a line is free of the boxes of all copies, found within LEAPS turns.
float freeOfCopies(CopyTraversal traversal) {
    bool comes = false;
    int turns = turnsOf(LEAPS, traversal.at);
    for (int i = 0; i < turns && !comes; ++i) {
        if (!nextCopy(traversal, NO_END, comes)) {
            return NO_END;
        }
    }
    return traversal.at;
}

// A result below every hit distance: the step limit was reached, and the first hit is unknown.
const float GIVEN_UP = -1.0;

uniform int uCopySteps;   // maximum turns of all traversals of long rows of copies in one flight

int copySteps;   // remaining turns

// Takes one of the remaining turns. Returns whether one was left.
bool takeCopyStep() {
    --copySteps;
    return copySteps >= 0;
}
