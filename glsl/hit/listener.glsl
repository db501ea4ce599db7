// Where a ray meets the listener; a wave that starts inside has arrived.
float hitListener(vec3 p, vec3 d) {
    vec3 offset = p - uListener.xyz;
    if (dot(offset, offset) <= uListener.w * uListener.w) {
        return 0.0;
    }
    return hitBall(offset, d, uListener.w);
}
