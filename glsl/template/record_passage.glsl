
    // Two records: one like that of a crossing, at the end of the flight, and the place.
    bool isPassage = met && passes(number, iteration);
    float marked = iteration + PASSAGE;
    vec4 way = vec4(sixteenths + (rest + t), d.z < 0.0 ? -marked : marked, d.xy);
    keepRecord(isPassage ? crossings - passedOver : -1.0, way);
    keepRecord(isPassage ? crossings + 1.0 - passedOver : -1.0, vec4(onto, object));
    crossings += isPassage ? 2.0 : 0.0;
