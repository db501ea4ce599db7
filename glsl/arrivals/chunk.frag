// A pass over the waves of a block: traces each wave through a chunk of iterations, and writes the
// wave's new state, a tally, and a record of each crossing of a detector.
//
//   first texture:   position x, y, z in metres, status
//   second texture:  direction x, y, z, metres flown from the source (rounded)
//   tally:           metres flown in the chunk as whole sixteenths and remainder, crossings + 16384 * fate,
//                    the first word of events
//   words:           four more words of events, only with materials
//   each record:     metres from the chunk's start to the middle of the chord; iteration + 64 * detector +
//                    chord * uChordScale, with the sign of the direction's z; direction x, y. With an inner
//                    sphere, x is rounded to steps, and its fraction is chord * uChordScale in the inner sphere
//
// A wave with more crossings than records is drawn again as an entry of a list; the crossings already
// recorded are then skipped.

uniform highp sampler2D uOrigins;      // the waves at the chunk's start
uniform highp sampler2D uDirections;
uniform highp sampler2D uList;         // each entry: number in the block (-1: unused), crossings to skip
uniform bool uIsListed;
uniform highp sampler2D uOriginals;    // after a resampling: the texel of each wave's original; -1: no wave
uniform bool uIsResampled;
uniform bool uIsStart;                 // whether the waves begin at the source
uniform uint uFirstWave;               // number of the block's first wave
uniform int uIterationsInChunk;

layout(location = 0) out vec4 outOrigin;
layout(location = 1) out vec4 outDirection;
layout(location = 2) out vec4 outTally;

const float CROSSINGS = 16384.0;   // more than a chunk can contain

float fate(float status) {
    return status >= 0.1 ? 0.0 : -status;
}

#if EVENT_BITS > 0
// Packs 30 bits into a float that is never NaN or subnormal, because drivers may change such values:
// bit 29 is 1, bit 30 is 0, and the sign bit holds the highest of the 30 bits.
float inFloat(uint bits) {
    return uintBitsToFloat(0x20000000u | (bits & 0x1FFFFFFFu) | ((bits & 0x20000000u) << 2u));
}

void prepareEvents(uint wave) {
    copyMaterials();@passing_wave@
#if SCATTERS
    waveNumber = wave;
    // Differs from the seed of the start directions.
    scatterSeed = uSeed ^ 0x5CA77E2Du;
    startIteration = uStartIteration;
    materialCount = uMaterialCount;
#endif
}
#else
void prepareEvents(uint wave) {}
#endif

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
    uint wave = uFirstWave + @number@;
    vec4 origin;
    vec4 direction;
    if (uIsStart) {
        startWave(wave, origin, direction);
    } else {
        ivec2 original = texel;
        if (uIsResampled) {
            float place = texelFetch(uOriginals, texel, 0).x;
            exists = exists && place >= 0.0;
            uint from = uint(max(place, 0.0));
            original = ivec2(from % uGridWidth, from / uGridWidth);
        }
        origin = texelFetch(uOrigins, original, 0);
        direction = texelFetch(uDirections, original, 0);
    }
    exists = exists && wave < uWaveCount;
    vec3 p = origin.xyz;
    vec3 d = direction.xyz;
    float status = exists ? origin.w : STATUS_DEAD;
    startLength = direction.w;
    int iterations = uIterationsInChunk;
    prepareEvents(wave);
#if EVENT_BITS > 0
    int done = 0;
    for (int word = 0; word < WORDS; ++word) {
        if (status < 0.1 || done >= iterations) {
            break;
        }
        uint events = 0u;
        uint unit = 1u;
        for (int place = 0; place < EVENTS_IN_WORD; ++place) {
            if (status < 0.1 || done >= iterations) {
                break;
            }
            events += unit * flyOn(float(done), p, d, status);
            unit <<= uint(EVENT_BITS);
            ++done;
        }
        keepWord(word, inFloat(events));
    }
#else
    for (int i = 0; i < iterations; ++i) {
        if (status < 0.1) {
            break;
        }
        flyOn(float(i), p, d, status);
    }
#endif
    outOrigin = vec4(p, status);
    outDirection = vec4(d, startLength + (sixteenths + rest));
    outTally = vec4(sixteenths, rest, crossings + CROSSINGS * fate(status), firstWord());
    writeOutputs();
}
