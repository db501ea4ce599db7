// From what is heard to the speakers. Three workers, as the window has three threads:
//
//   ears.js, traces what is heard in full ─▶ mix.js, mixes it ─▶ worklet.js, plays it
//
// so that neither a picture nor a trace holds up the sound. Nothing is shared: all is sent, and any server will do.

// Seconds in which the sound fades where it is stopped, and where it goes on: what is cut off clicks.
const FADE_S = 0.02;

// Why sound cannot be played here; nothing where it can.
function lacking() {
  if (!isSecureContext) {
    return "browsers play it over https:// or from localhost alone, and this address is neither";
  }
  if (typeof AudioWorkletNode === "undefined") return "this browser has no AudioWorklet";
  return "";
}

export class Sound {
  // Starts it: to be called from a click, since browsers play nothing before one. `told` is called with the name of
  // a part ("mix", "ears", "player") and what that says.
  static async start(told) {
    const why = lacking();
    if (why) throw new Error(why);
    const context = new AudioContext({ latencyHint: "interactive" });
    try {
      await context.audioWorklet.addModule("worklet.js");
      await context.resume();
      return new Sound(context, told);
    } catch (error) {
      // A page may have a few contexts only.
      await context.close();
      throw error;
    }
  }

  constructor(context, told) {
    this.context = context;
    // The number of the scene that was sent last, of the last that the mix has answered, and of the one it plays.
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
    const worker = new Worker(`${part}.js`, { type: "module" });
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

  // Whether what stands in the scene is of use: it is played, and it is known which scene is.
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

  // Ends it for good.
  close() {
    this.mix.terminate();
    this.ears.terminate();
    this.context.close();
  }

  // Another scene or another sound. What stands in the scene is sent by `stand`.
  play(text, name, sound) {
    this.sent += 1;
    this.mix.postMessage({ scene: this.sent, text, name, sound });
  }

  // What is listened to, its volume, and the balance.
  listen(listen, volume, profile, pan) {
    this.mix.postMessage({ listen, volume, profile, pan });
  }

  // The scene as it stands.
  stand(standing) {
    this.ears.postMessage({ ...standing, scene: this.playing });
  }
}
