// The initialise pass: one texel = one sound wave, at the source, in its own direction
// (thesis, section 3.2.3).

uniform vec3 uSource;        // metres, in the march's coordinates
uniform float uStartStatus;  // STATUS_STARTED, or STATUS_DEAD for a source in a solid
uniform uint uSeed;

layout(location = 0) out vec4 outOrigin;
layout(location = 1) out vec4 outDirection;

void main() {
    uint wave = waveIndex();
    if (wave >= uWaveCount) {
        outOrigin = vec4(0.0, 0.0, 0.0, STATUS_DEAD);
        outDirection = vec4(0.0);
        return;
    }
    outOrigin = vec4(uSource, uStartStatus);
    outDirection = vec4(startDirection(wave, uSeed), 0.0);
}
