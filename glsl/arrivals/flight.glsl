// One iteration of a wave that passes through the detectors, and the records of its crossings.

const float STATUS_GIVEN_UP = -2.0;   // a march reached its step limit; the wave is not followed further
const float STATUS_OVER = -3.0;       // has flown the requested length

uniform float uLengthLimit;   // metres from the source after which a wave is not followed further
uniform float uChordScale;    // 1 / (4 radii of the largest detector): scales a chord to at most a half
uniform vec4 uDetectors[DETECTORS];   // centre in the march's coordinates, radius
uniform int uDetectorCount;

#if LIMITS > 0
uniform vec4 uLimits[LIMITS * DETECTORS];   // planes in front of which a detector counts: unit normal, metres from its centre
#endif

#if INNER_SPHERE
uniform float uInnerRadii[DETECTORS];   // metres: a sphere within each detector, about the same centre
#endif
float lengthLimit = 0.0;
float chordScale = 0.0;
float startLength = 0.0;   // metres flown before the chunk, rounded
float passedOver = 0.0;    // crossings already recorded, to be skipped
#if SCATTERS
uniform uint uStartIteration;   // iterations before the chunk
uniform float uMaterialCount;

uint waveNumber = 0u;
uint scatterSeed = 0u;
uint startIteration = 0u;
float materialCount = 0.0;
#endif

// Metres flown in the chunk: the sum of whole sixteenths, and the sum of the remainders. Sixteenths add up
// exactly (to 2^20 m), and the sum of remainders stays so small that rounding costs at most 1e-7 m per
// flight. (A single sum in floats would lose 3e-5 m per flight beyond 512 m.)
float sixteenths = 0.0;
float rest = 0.0;
float crossings = 0.0;   // in the chunk

void addLength(float t) {
    float whole = floor(16.0 * t) * 0.0625;
    sixteenths += whole;
    rest += t - whole;
}

// The part of the flight from p along d within a detector's sphere.
struct Crossing {
    float along;          // metres from the closest point of the flight's line to p, along d
    float squaredAside;   // square of the line's distance from the centre
    float enters;         // metres from p to both ends of the part; enters >= leaves: the flight misses the sphere
    float leaves;
};

#if INNER_SPHERE
// The direction's x in whole steps of 1 / X_STEPS, plus the part of the flight within the inner sphere as a fraction
// below a half.
float xAndInnerChord(int detector, float x, Crossing crossing) {
    const float X_STEPS = 512.0;
    float squaredRadius = uInnerRadii[detector] * uInnerRadii[detector];
    float halfChord = sqrt(max(squaredRadius - crossing.squaredAside, 0.0));
    float leaves = min(halfChord - crossing.along, crossing.leaves);
    float chord = leaves - max(-crossing.along - halfChord, crossing.enters);
    return floor(X_STEPS * x + 0.5) + max(chord, 0.0) * chordScale;
}
#else
float xAndInnerChord(int detector, float x, Crossing crossing) {
    return x;
}
#endif

// Limits a crossing to the part in front of a detector's planes.
void limitCrossing(int detector, vec3 p, vec3 d, inout Crossing crossing) {
#if LIMITS > 0
    const float PARALLEL = 1e-20;   // a smaller slope counts as this one
    vec3 from = p - uDetectors[detector].xyz;
    for (int number = 0; number < LIMITS; ++number) {
        vec4 plane = uLimits[LIMITS * detector + number];
        float slope = dot(plane.xyz, d);
        slope = abs(slope) < PARALLEL ? PARALLEL : slope;
        float meets = (plane.w - dot(plane.xyz, from)) / slope;
        crossing.leaves = slope < 0.0 ? crossing.leaves : min(crossing.leaves, meets);
        crossing.enters = slope < 0.0 ? max(crossing.enters, meets) : crossing.enters;
    }
    // A crossing behind a plane has no length.
    crossing.leaves = max(crossing.leaves, crossing.enters);
#endif
}

// If the flight of t metres begins or ends inside, only the part of the chord that it covers counts.
Crossing crossingOf(int detector, vec3 p, vec3 d, float t) {
    vec4 sphere = uDetectors[detector];
    vec3 from = p - sphere.xyz;
    float along = dot(from, d);
    vec3 aside = from - along * d;
    float squaredAside = dot(aside, aside);
    float halfChord = sqrt(max(sphere.w * sphere.w - squaredAside, 0.0));
    return Crossing(along, squaredAside, max(-along - halfChord, 0.0), min(halfChord - along, t));
}

// Stores the record of a crossing at a place; -1: nowhere.
void recordCrossing(float place, int detector, Crossing crossing, vec3 d, float iteration) {
    const float ITERATIONS = 64.0;   // more than a chunk has
    float chord = crossing.leaves - crossing.enters;
    // The sign of the direction's third component is recorded separately; its magnitude follows
    // from the other two.
    float share = iteration + ITERATIONS * float(detector) + chord * chordScale;
    float middle = sixteenths + (rest + 0.5 * (crossing.enters + crossing.leaves));
    float x = xAndInnerChord(detector, d.x, crossing);
    keepRecord(place, vec4(middle, d.z < 0.0 ? -share : share, x, d.y));
}

// Counts and records the crossing of a detector. Few flights cross. llvmpipe executes the text of a condition even if it
// is false for all waves of a group, but not the turns of a loop that none of them enters.
void crossDetector(int detector, vec3 p, vec3 d, float t, float iteration) {
    Crossing crossing = crossingOf(detector, p, d, t);
    for (float turns = crossing.leaves > crossing.enters ? 1.0 : 0.0; turns > 0.0; turns -= 1.0) {
        limitCrossing(detector, p, d, crossing);
        bool crosses = crossing.leaves > crossing.enters;
        recordCrossing(crosses ? crossings - passedOver : -1.0, detector, crossing, d, iteration);
        crossings += crosses ? 1.0 : 0.0;
    }
}

void crossDetectors(vec3 p, vec3 d, float t, float iteration) {
#if DETECTORS > 1
    for (int detector = 0; detector < uDetectorCount; ++detector) {
        crossDetector(detector, p, d, t, iteration);
    }
#else
    crossDetector(0, p, d, t, iteration);
#endif
}

// Moves the wave to the next surface and reflects it there, specularly or diffusely. Returns the
// event, which determines the change of the wave's energy (src/shader/materials.rs).
uint flyOn(float iteration, inout vec3 p, inout vec3 d, inout float status) {
    float object;
    float t = fly(p, d, status, object);
    bool givenUp = t < 0.0;
    bool met = !givenUp && t < maxDistance;
    crossDetectors(p, d, t, iteration);
    vec3 onto = p;
    vec3 reflected = d;
    reflectWave(object, t, onto, reflected);
    uint event = 0u;
#if EVENT_BITS > 0
    vec3 turned = reflected - d;
    float material = materialAt(object, turned);
    float number = floor(material);@passage@
#if SCATTERS
    uvec3 bits = mixBits(uvec3(waveNumber, scatterSeed, startIteration + uint(iteration)));
    bool isScattered = unitInterval(bits.x) < 2.0 * (material - number);
    vec3 anywhere = scattered(turned, reflected, bits);
    reflected = isScattered ? anywhere : reflected;
    number += isScattered ? materialCount : 0.0;
#endif
    event = met ? uint(number) : 0u;
#endif
    addLength(met ? t : 0.0);
    p = met ? onto : p;
    d = met ? reflected : d;
    bool over = startLength + sixteenths > lengthLimit;
    status = met ? (over ? STATUS_OVER : object) : givenUp ? STATUS_GIVEN_UP : STATUS_DEAD;
    return event;
}
