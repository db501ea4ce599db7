// A coordinate relative to one of the copies along an axis, which are numbered first to last:
// the one whose cell it lies in, moved on by a step and held.
float repeatCopy(float q, float period, float first, float last, float step_) {
    float own = clamp(floor(q / period + 0.5), first, last);
    return q - period * clamp(own + step_, first, last);
}

// Towards the nearer of the neighbouring cells.
float repeatSide(float q, float period, float first, float last) {
    return q >= period * clamp(floor(q / period + 0.5), first, last) ? 1.0 : -1.0;
}

// What the value of a repeated bound is held at, so that it does not jump where another copy is
// evaluated: near among the copies; beyond the box about all of them the way to it, divided by
// how slow the value may be.
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
    vec3 axis = most == beyond.x ? vec3(1.0, 0.0, 0.0)
        : most == beyond.y ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
    return inverse * vec4(side * axis, most);
}

// How far a coordinate q goes on in the cell of its copy; the first and the last have no end.
float copyReach(float q, float d, float period, float first, float last) {
    float own = clamp(floor(q / period + 0.5), first, last);
    if (d == 0.0 || (d > 0.0 ? own == last : own == first)) {
        return NO_END;
    }
    return max(((own + (d > 0.0 ? 0.5 : -0.5)) * period - q) / d, 0.0);
}

// A line past repeated copies that keep apart, each within a box about its middle.
//
// Theory. Cell by cell (Amanatides and Woo 1987) a line is taken past every copy. Here it is
// taken from box to box: along each axis the walk knows the next copy that the line is level
// with, where it comes level with its box, and where it leaves that. Where the line is level with
// a box along all three axes, it comes into it; else every axis whose box ends before that goes on
// to the copy that is there, however many lie between. So a line that flies between two layers of
// copies is at their next crossing in one turn.
//
// Every axis is seen in the direction of the line: numbers and places are mirrored where the line
// goes down it. Numbers are whole, and exact in a float up to 2^24; boxes are grown by what
// rounding may do to places there, so that none is passed by.

struct CopyWalk {
    vec3 side;      // 1, or -1 where the line goes down an axis
    vec3 start;     // of the line, metres
    vec3 speed;     // metres along each axis a metre of the line
    vec3 inverse;   // 1 / speed
    vec3 period;    // from one copy to the next, metres; anything along an axis without repetition
    vec3 front;     // of the box about a copy's middle: where the line comes level with it
    vec3 back;      // where it leaves that
    vec3 last;      // the number of the last copy
    float slack;    // what rounding may do to the start, metres
    vec3 copy;      // the copies whose boxes it is level with next
    vec3 met;       // the copy whose box it has come into, numbered along the axes
    float at;       // where, metres along the line
    bool ended;     // whether there are no more
};

// What rounding may do to places that far away.
vec3 copySlack(CopyWalk walk, vec3 place) {
    return walk.slack + ROUNDING * (abs(walk.start) + abs(place));
}

// The first copies that the line has not left behind along each axis, after `way` metres.
vec3 copiesAhead(CopyWalk walk, float way) {
    vec3 place = walk.start + way * walk.speed;
    return ceil((place - walk.back - copySlack(walk, place)) / walk.period);
}

// The walk of the line q + t d past copies from number first to number last in their boxes from
// least to most.
CopyWalk walkCopies(vec3 q, vec3 d, float slack, vec3 period, vec3 least, vec3 most, vec3 first, vec3 last) {
    CopyWalk walk;
    walk.inverse = safeInverse(d);
    bvec3 up = greaterThan(walk.inverse, vec3(0.0));
    walk.side = vec3(up.x ? 1.0 : -1.0, up.y ? 1.0 : -1.0, up.z ? 1.0 : -1.0);
    walk.start = walk.side * q;
    walk.speed = abs(d);
    walk.inverse = abs(walk.inverse);
    walk.period = period;
    walk.front = vec3(up.x ? least.x : -most.x, up.y ? least.y : -most.y, up.z ? least.z : -most.z);
    walk.back = vec3(up.x ? most.x : -least.x, up.y ? most.y : -least.y, up.z ? most.z : -least.z);
    walk.last = vec3(up.x ? last.x : -first.x, up.y ? last.y : -first.y, up.z ? last.z : -first.z);
    walk.slack = slack;
    vec3 lowest = vec3(up.x ? first.x : -last.x, up.y ? first.y : -last.y, up.z ? first.z : -last.z);
    walk.copy = max(lowest, copiesAhead(walk, 0.0));
    walk.met = vec3(0.0);
    walk.at = 0.0;
    walk.ended = false;
    return walk;
}

// On to where the line is next level with boxes along all axes, or may be: whether it comes into the
// box of the copy walk.met there.
bool comesIntoBox(inout CopyWalk walk, float limit) {
    vec3 middle = walk.period * walk.copy;
    vec3 slack = copySlack(walk, middle);
    vec3 enters = (middle + walk.front - slack - walk.start) * walk.inverse;
    vec3 leaves = (middle + walk.back + slack - walk.start) * walk.inverse;
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    walk.at = max(max(enters.x, max(enters.y, enters.z)), 0.0);
    walk.met = walk.side * walk.copy;
    walk.ended = walk.at >= limit || any(greaterThan(walk.copy, walk.last));
    float way = max(walk.at, leave);
    vec3 next = max(walk.copy + 1.0, copiesAhead(walk, way));
    bvec3 left = lessThanEqual(leaves, vec3(way));
    walk.copy = vec3(left.x ? next.x : walk.copy.x, left.y ? next.y : walk.copy.y, left.z ? next.z : walk.copy.z);
    return walk.at <= leave && !walk.ended;
}

// One turn: whether the line comes into a box. False where there are no more before limit. Most
// boxes are found within three tries, and turns are what a loop has few of.
bool nextCopy(inout CopyWalk walk, float limit, out bool comes) {
    comes = comesIntoBox(walk, limit);
    if (!comes && !walk.ended) {
        comes = comesIntoBox(walk, limit);
    }
    if (!comes && !walk.ended) {
        comes = comesIntoBox(walk, limit);
    }
    return !walk.ended;
}

const int LEAPS = 4;   // turns of a walk past copies that a bound is worth

// How far a line is free of the boxes of all copies, as far as so many turns tell.
float freeOfCopies(CopyWalk walk) {
    bool comes = false;
    for (int i = 0; i < LEAPS && !comes; ++i) {
        if (!nextCopy(walk, NO_END, comes)) {
            return NO_END;
        }
    }
    return walk.at;
}

// "The step limit was reached": nothing is known of what the line meets. Less than every hit.
const float GIVEN_UP = -1.0;

uniform int uCopySteps;   // turns of all walks past long rows of copies in one flight at the most

int copySteps;   // turns that are left of these

// Takes one of them. False where none is left.
bool takeCopyStep() {
    --copySteps;
    return copySteps >= 0;
}
