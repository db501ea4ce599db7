@outputs@
// Stores the record by its index, if there is an output for this index.
void keepRecord(float place, vec4 record) {
@keep@
}

@words@
void writeOutputs() {
@write@
}

