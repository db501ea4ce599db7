// Plays blocks of samples in the browser's audio thread, and requests further blocks.

// Number of buffered frames. The buffered frames last 85 ms at 48 kHz, the time in which a delayed worker can catch up.
const AHEAD = 4096;
// Number of frames in a request.
const BLOCK = 512;
// Number of frames of a fade before and after a gap: 5 ms at 48 kHz.
const FADE = 240;
// Interval between two reports of the levels, in seconds.
const TOLD_EVERY = 0.1;

class PlayerOfBlocks extends AudioWorkletProcessor {
  constructor() {
    super();
    this.mix = null;
    this.blocks = [];
    // Index of the next sample in the first block, and the number of frames left in all blocks.
    this.at = 0;
    this.inHand = 0;
    // Number of frames that were requested but not played yet.
    this.asked = 0;
    // Progress of the fade in frames: 0 is silence, FADE is full level.
    this.fade = 0;
    this.isPlaying = false;
    this.gaps = 0;
    this.left = 0;
    this.right = 0;
    this.frames = 0;
    this.port.onmessage = ({ data }) => this.begin(data.mix);
  }

  begin(mix) {
    this.mix = mix;
    mix.onmessage = ({ data: block }) => {
      this.blocks.push(block);
      this.inHand += block.length / 2;
    };
  }

  // Requests the missing frames.
  ask() {
    if (!this.mix) return;
    while (this.asked < AHEAD) {
      this.mix.postMessage(BLOCK);
      this.asked += BLOCK;
    }
  }

  process(inputs, outputs) {
    const [left, right] = outputs[0];
    this.ask();
    let frame = 0;
    while (frame < left.length && this.inHand > 0) {
      this.play(left, right, frame);
      frame += 1;
    }
    const hasGap = frame < left.length;
    if (hasGap && this.isPlaying) this.gaps += 1;
    this.isPlaying = !hasGap;
    this.tell(left, right);
    return true;
  }

  // Plays the next frame. The sound fades out towards the end of the buffered frames, so that a gap does not click.
  play(left, right, frame) {
    const block = this.blocks[0];
    this.fade += this.fade < Math.min(FADE, this.inHand) ? 1 : 0;
    this.fade = Math.min(this.fade, this.inHand - 1);
    const gain = this.fade / FADE;
    left[frame] = gain * block[this.at];
    right[frame] = gain * block[this.at + 1];
    this.at += 2;
    this.inHand -= 1;
    this.asked -= 1;
    if (this.at >= block.length) {
      this.blocks.shift();
      this.at = 0;
    }
  }

  tell(left, right) {
    for (let frame = 0; frame < left.length; frame++) {
      this.left += left[frame] ** 2;
      this.right += right[frame] ** 2;
    }
    this.frames += left.length;
    if (this.frames < TOLD_EVERY * sampleRate) return;
    const level = (sum) => 10 * Math.log10(sum / this.frames + 1e-12);
    this.port.postMessage({ levels: [level(this.left), level(this.right)], gaps: this.gaps });
    this.left = 0;
    this.right = 0;
    this.frames = 0;
  }
}

registerProcessor("player", PlayerOfBlocks);
