// The user's field 0 on a line: the second derivative of its own value is at least -sag, as stated and checked, up to
// the surface. Its upper limit is unknown, and so is any limit across the faces of the box.
OnLine onLineUser0(vec3 p, vec3 d, vec3 halfSize, float inverseLipschitz, float sag) {
    const float NO_LIMIT = 1e20;
    vec2 valueAndSlope = slopeUser0(p, d, halfSize, inverseLipschitz);
    float outside = sdBox(p, halfSize);
    float reach = min(-outside, 0.5 * (valueAndSlope.x - outside));
    return OnLine(valueAndSlope.x, valueAndSlope.y, sag, NO_LIMIT, max(reach, 0.0));
}
