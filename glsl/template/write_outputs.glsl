@outputs@
// Keeps the record at its place, if it has that place.
void keepRecord(float place, vec4 record) {
@keep@
}

@words@
void writeOutputs() {
@write@
}

