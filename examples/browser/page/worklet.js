// Plays blocks of samples, in the browser's own thread for sound, and asks for the next ones.

// Frames that are in hand: 85 ms at 48 kHz, in which a worker that was held up comes back.
const AHEAD = 4096;
// Frames that are asked for at once.
const BLOCK = 512;
// Seconds between two levels told.
const TOLD_EVERY = 0.1;

registerProcessor("player", class extends AudioWorkletProcessor {
  constructor() {
    super();
    this.blocks = [];
    this.at = 0;
    this.asked = 0;
    this.hasBegun = false;
    this.gaps = 0;
    this.sums = [0, 0];
    this.frames = 0;
    this.port.onmessage = ({ data }) => {
      this.mix = data.mix;
      this.mix.onmessage = ({ data: block }) => this.blocks.push(block);
    };
  }

  // Asks for what is missing.
  ask() {
    for (; this.mix && this.asked < AHEAD; this.asked += BLOCK) this.mix.postMessage(BLOCK);
  }

  process(_, [[left, right]]) {
    this.ask();
    for (let i = 0; i < left.length; i++) {
      const block = this.blocks[0];
      if (!block) {
        this.gaps += this.hasBegun ? 1 : 0;
        break;
      }
      this.hasBegun = true;
      [left[i], right[i]] = [block[this.at], block[this.at + 1]];
      this.at += 2;
      this.asked -= 1;
      if (this.at >= block.length) {
        this.blocks.shift();
        this.at = 0;
      }
    }
    this.tell(left, right);
    return true;
  }

  tell(left, right) {
    for (let i = 0; i < left.length; i++) {
      this.sums[0] += left[i] ** 2;
      this.sums[1] += right[i] ** 2;
    }
    this.frames += left.length;
    if (this.frames < TOLD_EVERY * sampleRate) return;
    const levels = this.sums.map((sum) => 10 * Math.log10(sum / this.frames + 1e-12));
    this.port.postMessage({ levels, gaps: this.gaps });
    [this.sums, this.frames] = [[0, 0], 0];
  }
});
