@declared@
// Keeps a word of events at its place.
void keepWord(int place, float word) {
@keep@
}

float firstWord() { return word0; }

