// The initialise pass: one texel = one sound wave, at its start.

layout(location = 0) out vec4 outOrigin;
layout(location = 1) out vec4 outDirection;

void main() {
    uint wave = @wave@;
    if (wave >= uWaveCount) {
        outOrigin = vec4(0.0, 0.0, 0.0, STATUS_DEAD);
        outDirection = vec4(0.0);
        return;
    }
    startWave(wave, outOrigin, outDirection);
}
