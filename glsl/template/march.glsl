// Returns the distance along the ray to the first hit before limit, or -1.
float march@name@(vec3 origin, vec3 d, float @given@, float limit, out float object, out bool limitReached) {
    const bool isFree = @is_free@;   // whether all steps are free, as slope and bend of every field show
    float size = largest(origin);
@start@
    March march = March(0.0, 0.0, start, start);
    bool isHit = false;
    bool isBeyond = start >= limit;
    int stepLimit = isBeyond ? 0 : @steps@;
    object = -1.0;
    float t = 0.0;
    float root = 0.0;
    int i = 0;
    for (; i < stepLimit; ++i) {
        t = march.proven + march.trial;
        vec3 p = origin + t * d;
        float rounding = ROUNDING * max(largest(p), size);
        Ahead ahead = @ahead@;
        COUNT_EVALUATIONS(1.0);
        object = ahead.object;
        float value = ahead.nearest.value;
        float touch = PLACE * max(rounding, ahead.errorBound);
        float near = NEAR * touch;
        bool isFirst = t <= 0.0 && i == 0;
        bool isNear = march.free < near;
        bool isProven = isFree || isNear || march.trial <= march.free || value + march.free >= march.trial;
        float slope = isFree ? ahead.nearest.slope : slopeOf(ahead, march, near);
        root = max(-value / min(slope, -FLATTEST), -SHALLOW * touch);
        bool touches = !isFirst && isTouch(value, slope, touch);
        bool isSolid = isProven && value < -touch && !isFirst;
        bool isEnclosed = isSolid && (isFree || march.trial <= touch);
        isHit = isProven && slope < 0.0 && (touches || isEnclosed || isTangentHit(ahead, slope, root));
        float free = min(ahead.free, ahead.others);
        isBeyond = isProven && t + (isHit ? 0.0 : min(free, ahead.cell)) >= limit;
        if (isHit || isBeyond) {
            break;
        }
        if (isProven && (isFree || !isSolid)) {
            float way = isFree ? max(min(free, ahead.cell), 0.5 * touch) : stepAhead(ahead, slope, touch);
            march = March(t, max(value, 0.0), max(free, 0.0), way);
        } else {
            march.trial = stepBack(march, value, isSolid);
        }
    }
@taken@
    t = isHit ? max(t + root, 0.0) : t;
    limitReached = !isHit && !isBeyond;
    return isHit && t < limit ? t : -1.0;
}
