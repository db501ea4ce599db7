// The listener: centre in metres, in the march's coordinates; radius.
uniform vec4 uListener;

float listenerDistance(vec3 p) {
    return length(p - uListener.xyz) - uListener.w;
}
