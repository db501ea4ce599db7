// The listener: centre in metres, in the march's coordinates; radius.
uniform vec4 uListener;

float listenerDistance(vec3 p) {
    return length(p - uListener.xyz) - uListener.w;
}

// Distance to the listener if a wave along d can still meet it: one that it recedes from is
// never met, and a wave that starts inside has arrived.
float sdListenerDirected(vec3 p, vec3 d) {
    const float NEVER = 1e30;
    vec3 offset = p - uListener.xyz;
    float nearest = length(offset) - uListener.w;
    return nearest > 0.0 && dot(offset, d) >= 0.0 ? NEVER : nearest;
}

// Where a ray intersects the listener; a wave that starts inside has arrived.
float hitListener(vec3 p, vec3 d) {
    vec3 offset = p - uListener.xyz;
    if (dot(offset, offset) <= uListener.w * uListener.w) {
        return 0.0;
    }
    return hitBall(offset, d, uListener.w);
}
