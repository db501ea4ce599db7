@declared@
// Stores a word of events by its index.
void keepWord(int place, float word) {
@keep@
}

float firstWord() { return word0; }

