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
