// From what is heard to the speakers. Three workers, as the window has three threads:
//
//   ears.js, traces what is heard in full ─▶ mix.js, mixes it ─▶ worklet.js, plays it
//
// so that neither a picture nor a trace holds up the sound. Nothing is shared: all is sent, and any server will do.

export class Sound {
  // Starts it: to be called from a click, since browsers play nothing before one. `told` is called with what the
  // workers say.
  static async start(told) {
    const context = new AudioContext({ latencyHint: "interactive" });
    await context.audioWorklet.addModule("worklet.js");
    await context.resume();
    return new Sound(context, told);
  }

  constructor(context, told) {
    this.context = context;
    this.output = new AudioWorkletNode(context, "player", { numberOfInputs: 0, outputChannelCount: [2] });
    this.output.connect(context.destination);
    const worker = (file) => {
      const made = new Worker(file, { type: "module" });
      made.onmessage = ({ data }) => told(data);
      made.onerror = (event) => told({ failed: event.message ?? `${file} cannot be loaded` });
      return made;
    };
    [this.mix, this.ears] = [worker("mix.js"), worker("ears.js")];
    const [toPlayer, toEars] = [new MessageChannel(), new MessageChannel()];
    this.output.port.postMessage({ mix: toPlayer.port1 }, [toPlayer.port1]);
    this.output.port.onmessage = ({ data }) => told(data);
    const rate = context.sampleRate;
    this.mix.postMessage({ rate, player: toPlayer.port2, ears: toEars.port1 }, [toPlayer.port2, toEars.port1]);
    this.ears.postMessage({ rate, mix: toEars.port2 }, [toEars.port2]);
    this.scene = 0;
  }

  // Another scene or another sound. What stands in the scene is sent by `stand`.
  play(text, name, sound) {
    this.scene += 1;
    this.mix.postMessage({ scene: this.scene, text, name, sound });
  }

  // What is listened to, its volume, and the balance.
  listen(listen, volume, profile, pan) {
    this.mix.postMessage({ listen, volume, profile, pan });
  }

  // The scene as it stands.
  stand(standing) {
    this.ears.postMessage({ ...standing, scene: this.scene });
  }
}
