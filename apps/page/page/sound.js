// The sound, from the responses to the loudspeakers. Three parts run beside the page, like the three threads of the
// window:
//
//   ears.js (traces full listening) ─▶ mix.js (mixes the responses) ─▶ worklet.js (plays the mix)
//
// Neither drawing nor tracing can therefore interrupt the sound. The parts share no memory, so any server can host the
// page without special headers.

// Duration of the fade when the sound is stopped or resumed, in seconds. A sudden cut would click.
const FADE_S = 0.02;

// Returns the reason why this browser cannot play sound; "" if it can.
function lacking() {
  if (!isSecureContext) {
    return "browsers play sound only over https:// or from localhost, and this address is neither";
  }
  if (typeof AudioWorkletNode === "undefined") return "this browser has no AudioWorklet";
  return "";
}

// Workers that load their wasm before the click, so that the sound begins sooner.
const prepared = new Map();

function load(part) {
  return new Worker(`${part}.js`, { type: "module" });
}

// Loads the workers of the first sound. A worker that fails is loaded again, and reports its failure, when the sound
// starts. `report` is called with each message of the ears on the compilation of shaders.
export function prepare(report) {
  for (const part of ["mix", "ears"]) {
    const worker = load(part);
    worker.onmessage = ({ data }) => {
      if (data.compiles !== undefined) report(data);
    };
    worker.onerror = () => {
      prepared.delete(part);
      if (part === "ears") report({ compiles: false });
    };
    prepared.set(part, worker);
  }
}

// Lets the ears trace a scene before the click: its text, its name and its state.
export function prepareEars(scene) {
  prepared.get("ears")?.postMessage({ prepare: scene });
}

export class Sound {
  // Starts the sound. This function must be called from a click handler, because browsers play no sound before a click.
  // `told` receives the name of a part ("mix", "ears", "player") and its message.
  static async start(told) {
    const why = lacking();
    if (why) throw new Error(why);
    const context = new AudioContext({ latencyHint: "interactive" });
    try {
      await context.audioWorklet.addModule("worklet.js");
      await context.resume();
      return new Sound(context, told);
    } catch (error) {
      // A page may have only a few audio contexts.
      await context.close();
      throw error;
    }
  }

  constructor(context, told) {
    this.context = context;
    // The numbers of three scenes: the last one sent, the last one that the mix has answered, and the one it plays.
    this.sent = 0;
    this.answered = 0;
    this.playing = 0;
    this.output = new AudioWorkletNode(context, "player", { numberOfInputs: 0, outputChannelCount: [2] });
    this.volume = new GainNode(context);
    this.output.connect(this.volume).connect(context.destination);
    this.mix = this.worker("mix", told);
    this.ears = this.worker("ears", told);
    const toPlayer = new MessageChannel();
    const toEars = new MessageChannel();
    this.output.port.postMessage({ mix: toPlayer.port1 }, [toPlayer.port1]);
    this.output.port.onmessage = ({ data }) => told("player", data);
    this.output.onprocessorerror = () => told("player", { failed: "worklet.js has failed" });
    const rate = context.sampleRate;
    this.mix.postMessage({ rate, player: toPlayer.port2, ears: toEars.port1 }, [toPlayer.port2, toEars.port1]);
    this.ears.postMessage({ rate, mix: toEars.port2 }, [toEars.port2]);
  }

  worker(part, told) {
    const worker = prepared.get(part) ?? load(part);
    prepared.delete(part);
    worker.onmessage = ({ data }) => {
      if (data.answered !== undefined) {
        this.answered = data.answered;
        this.playing = data.playing;
      }
      told(part, data);
    };
    worker.onerror = (event) => told(part, { failed: event.message ?? `${part}.js cannot be loaded` });
    return worker;
  }

  isRunning() {
    return this.context.state === "running";
  }

  // Whether the ears can use the state of the scene: sound is running, and the mix has answered which scene it plays.
  isListening() {
    return this.isRunning() && this.playing > 0 && this.answered === this.sent;
  }

  async stop() {
    this.glideTo(0);
    await new Promise((done) => setTimeout(done, 2000 * FADE_S));
    await this.context.suspend();
  }

  async goOn() {
    await this.context.resume();
    this.glideTo(1);
  }

  glideTo(volume) {
    const gain = this.volume.gain;
    const now = this.context.currentTime;
    gain.cancelScheduledValues(now);
    gain.setValueAtTime(gain.value, now);
    gain.linearRampToValueAtTime(volume, now + FADE_S);
  }

  // Ends the sound permanently.
  close() {
    this.mix.terminate();
    this.ears.terminate();
    this.context.close();
  }

  // Plays another scene or another sound. `stand` sends the state of the scene.
  play(text, name, sound) {
    this.sent += 1;
    this.mix.postMessage({ scene: this.sent, text, name, sound });
  }

  // Sets the listening mode (full or balance), the volume, and the pan.
  listen(listen, volume, profile, pan) {
    this.mix.postMessage({ listen, volume, profile, pan });
  }

  // Sends the state of the scene.
  stand(standing) {
    this.ears.postMessage({ ...standing, scene: this.playing });
  }
}
