// The start of a wave: at the source, in its own direction (thesis, section 3.2.3).

uniform vec3 uSource;        // metres, in the march's coordinates
uniform float uStartStatus;  // STATUS_STARTED, or STATUS_DEAD for a source in a solid
uniform uint uSeed;

void startWave(uint wave, out vec4 origin, out vec4 direction) {
    origin = vec4(uSource, uStartStatus);
    direction = vec4(startDirection(wave, uSeed), 0.0);
}
