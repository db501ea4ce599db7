// Distance to a box that a wave along d can still meet, or NEVER. A wave that is beyond a face
// and does not come nearer to its plane never meets the box. Where rounding decides on which
// side of a face it is, it counts as beyond; a wave deeper in the box is beyond the nearest face.
float sdBoxAhead(vec3 p, vec3 d, vec4 halfSizeAndSlack) {
    const float NEVER = 1e30;
    vec3 away = vec3(p.x < 0.0 ? -d.x : d.x, p.y < 0.0 ? -d.y : d.y, p.z < 0.0 ? -d.z : d.z);
    vec3 beyond = abs(p) - halfSizeAndSlack.xyz;
    float furthest = max(beyond.x, max(beyond.y, beyond.z));
    float slack = halfSizeAndSlack.w;
    float face = furthest > slack ? 0.0 : min(furthest, -slack);
    vec3 receding = vec3(
        away.x >= 0.0 ? beyond.x : -NEVER,
        away.y >= 0.0 ? beyond.y : -NEVER,
        away.z >= 0.0 ? beyond.z : -NEVER);
    bool recedes = max(receding.x, max(receding.y, receding.z)) >= face;
    return recedes ? NEVER : length(max(beyond, 0.0)) + min(furthest, 0.0);
}
