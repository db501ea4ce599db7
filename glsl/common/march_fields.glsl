// Sphere tracing of fields: surfaces without a closed-form intersection, or with a solid that is
// not convex, where a Newton step may overshoot.
//
// Theory (the proof is in docs/accuracy.md). Up to `proven` metres along the ray there is no surface, nor in the `free`
// metres beyond. A trial at proven + trial metres extends this in one of two ways: the trial lies in the free metres, or
// the empty ball around it touches them (Keinert et al. 2014, "Enhanced sphere tracing"; Balint and Valasek 2018 for the
// step from the slope). A trial that does neither is repeated nearer. Free metres are the least value of the fields
// (Hart 1996), or more where a field's slope and bend on the line, or a lower bound along it, show more.

uniform int uFieldSteps;   // maximum number of evaluations in one march

const float PLACE = 0.25;      // share of ROUNDING that is the error of a position
const float NEAR = 64.0;       // distance to a surface, in roundings, below which steps end where the tangent meets 0
const float RELAXED = 0.95;    // share of the step at which the balls would just touch
const float SHALLOW = 64.0;    // maximum distance of a hit, in roundings along the ray
const float TANGENT = 2e-7;    // maximum error of a hit where the tangent meets 0, metres
const float CHORD_MARGIN = 4.0;   // distance from the ends of chords, in roundings, at which they are left
const float EARLY = 6.0;       // distance of a chord's begin, in roundings, at which a wave at its start is on the chord
const float GLANCING = 4.0;    // inverse of the slope below which a value is compared with less than `touch`
const float FLAT = 0.0625;     // least share of `touch` with which a value is compared
const float FLATTEST = 1e-3;   // least slope of a tangent, metres per metre

// The state of a march.
struct March {
    float proven;   // distance without a surface, metres
    float value;    // value there; 0 in the solid, within rounding
    float free;     // further distance without a surface, metres
    float trial;    // from `proven` to the next evaluation, metres
};

// The free length at the start by the chords, of which those count that the wave enters within `early` metres. A wave
// that leaves the surface of a convex part of the air is free up to the end of this part.
float freeBy(float through, float early) {
    return through > early ? through : 0.0;
}

// The slope of the nearest field on the line: its own, or that of the last two values.
float slopeOf(Ahead ahead, March march, float near) {
    float value = ahead.nearest.value;
    float known = ahead.nearest.slope;
    float measured = march.trial > 0.0 ? (value - march.value) / march.trial : value < near ? 0.5 : -1.0;
    return known < UNKNOWN ? known : measured;
}

// Whether the tangent at a value shows the hit: the second derivative moves it by at most TANGENT, and no edge and no
// other field lies in between.
bool isTangentHit(Ahead ahead, float slope, float root) {
    float value = abs(ahead.nearest.value);
    float bend = max(ahead.nearest.sag, ahead.nearest.rise);
    return 0.5 * bend * value * value < TANGENT * slope * slope && 4.0 * bend * value < slope * slope
        && root <= min(ahead.nearest.reach, ahead.others);
}

// Whether a value is within rounding of a hit, and the tangent meets 0 nearby. A field may grow far more slowly than the
// distance, and its slope shows this: just outside the solid the value must be smaller by as much.
bool isTouch(float value, float slope, float touch) {
    float most = value > 0.0 ? touch * clamp(GLANCING * -slope, FLAT, 1.0) : touch;
    return abs(value) <= most && value <= -SHALLOW * touch * slope;
}

// The step from a proven point.
float stepAhead(Ahead ahead, float slope, float touch) {
    float value = ahead.nearest.value;
    float free = min(ahead.free, ahead.others);
    float relaxed = RELAXED * 2.0 * value / (1.0 - clamp(slope, -1.0, 0.9));
    float near = NEAR * touch;
    float last = slope < 0.0 ? min(-value / slope, 4.0 * near) : near;
    float way = max(free, value < near ? last : relaxed);
    // The ball may contain surfaces of other cells, which this cell does not list, and the next ball would
    // miss surfaces of this cell: only a free step may leave the cell.
    way = way < ahead.within ? way : min(free, ahead.cell);
    return max(way, 0.5 * touch);
}

// The trial after one that is not proven, or in the solid.
float stepBack(March march, float value, bool isSolid) {
    if (isSolid) {
        return max(march.trial * march.value / (march.value - value), 0.0);
    }
    return max(march.free, RELAXED * 2.0 * march.value * march.trial / (march.trial - value + march.value));
}
