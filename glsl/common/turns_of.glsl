// The number of turns of a loop that most waves leave early: `most`, for every finite position. The number is not a
// constant, because compilers unroll a loop with a constant number of turns. A renderer that draws waves in lockstep then
// computes all turns for all waves.
int turnsOf(int most, float size) {
    const float INFINITE = 1e30;   // metres
    return size < INFINITE ? most : 0;
}
