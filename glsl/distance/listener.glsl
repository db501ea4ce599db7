// The listener: centre in world metres, radius.
uniform vec4 uListener;

float listenerDistance(vec3 p) {
    return length(p - uListener.xyz) - uListener.w;
}
