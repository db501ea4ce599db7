// A pass over the waves of a block: takes each through a chunk of iterations, and writes where it
// stands then, a tally, and records of its crossings of the listener.
//
//   first texture:   position x, y, z in metres, status
//   second texture:  direction x, y, z, metres flown from the source (rounded)
//   tally:           metres flown in the chunk as whole sixteenths and rest, crossings + 1024 * fate
//   each record:     metres from the chunk's start to the middle of the chord; iteration +
//                    chord * uChordScale, with the sign of the direction's z; direction x, y
//
// A wave with more crossings than there are records is drawn once more, as one of a list, with
// those that are recorded passed over.

uniform highp sampler2D uOrigins;      // the waves at the chunk's start
uniform highp sampler2D uDirections;
uniform highp sampler2D uList;         // number in the block or -1, crossings to pass over
uniform bool uIsListed;
uniform bool uIsStart;                 // the waves are at the source
uniform uint uFirstWave;               // of the block
uniform int uIterationsInChunk;

layout(location = 0) out vec4 outOrigin;
layout(location = 1) out vec4 outDirection;
layout(location = 2) out vec4 outTally;

const float CROSSINGS = 1024.0;   // more than a chunk has

float fate(float status) {
    return status >= 0.1 ? 0.0 : -status;
}

void main() {
    copyUniforms();
    copySettings();
    lengthLimit = uLengthLimit;
    chordScale = uChordScale;
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint number = waveIndex();
    bool exists = true;
    if (uIsListed) {
        vec4 entry = texelFetch(uList, texel, 0);
        exists = entry.x >= 0.0;
        number = uint(max(entry.x, 0.0));
        texel = ivec2(number % uGridWidth, number / uGridWidth);
        passedOver = entry.y;
    }
    uint wave = uFirstWave + number;
    vec4 origin;
    vec4 direction;
    if (uIsStart) {
        startWave(wave, origin, direction);
    } else {
        origin = texelFetch(uOrigins, texel, 0);
        direction = texelFetch(uDirections, texel, 0);
    }
    exists = exists && wave < uWaveCount;
    vec3 p = origin.xyz;
    vec3 d = direction.xyz;
    float status = exists ? origin.w : STATUS_DEAD;
    startLength = direction.w;
    int iterations = uIterationsInChunk;
    for (int i = 0; i < iterations; ++i) {
        if (status < 0.1) {
            break;
        }
        flyOn(float(i), p, d, status);
    }
    outOrigin = vec4(p, status);
    outDirection = vec4(d, startLength + (sixteenths + rest));
    outTally = vec4(sixteenths, rest, crossings + CROSSINGS * fate(status), 0.0);
    writeRecords();
}
