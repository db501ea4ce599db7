// Where a ray meets the listener; a wave that starts inside has arrived.
float hitListener(vec3 p, vec3 d) {
    vec3 offset = p - uListener.xyz;
    if (dot(offset, offset) <= uListener.w * uListener.w) {
        return 0.0;
    }
    float along = dot(offset, d);
    vec3 aside = offset - along * d;
    float under = uListener.w * uListener.w - dot(aside, aside);
    if (along >= 0.0 || under <= 0.0) {
        return NO_HIT;
    }
    return max(-along - sqrt(under), 0.0);
}
