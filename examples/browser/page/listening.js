// What the page plays: starts and stops the sound, tells it what is chosen and what stands in the scene, and keeps what
// its workers say.

import { Sound } from "./sound.js";

// Decibels where nothing is played.
const SILENCE_DB = -120;

const $ = (id) => document.getElementById(id);

export class Listening {
  // Of a page (Page) and what is chosen; nothing is played yet.
  constructor(page, state, messages) {
    this.page = page;
    this.state = state;
    this.messages = messages;
    this.sound = null;
    // The scene that is shown: the last text that was one.
    this.shown = null;
    // Whether what is heard in full can be traced.
    this.hasEars = true;
    this.gaps = 0;
    // What stood in the scene when the ears were told last.
    this.stood = "";
    this.forget();
  }

  // Nothing was heard yet.
  forget() {
    this.levels = [SILENCE_DB, SILENCE_DB];
    this.sources = [];
    this.times = { trace: NaN, late: NaN };
  }

  // Whether it is heard in full, as far as what is chosen is concerned.
  isFull() {
    return this.hasEars && this.state.listen === "full" && this.state.profile !== "thesis";
  }

  // Plays the scene of that text from now on, once there is sound.
  play(shown) {
    this.shown = shown;
    // What was heard is of the scene before.
    this.sources = [];
    this.sound?.play(shown.text, shown.name, this.state.sound);
  }

  // Tells the sound what is listened to.
  hear() {
    const pan = this.page.frame()[5] ?? 0;
    this.sound?.listen(this.isFull() ? "full" : "balance", this.state.volume, this.state.profile, pan);
  }

  // Sends the scene as it stands to the ears, if it has changed.
  stand() {
    if (!this.sound?.isListening() || !this.isFull()) return;
    const page = this.page;
    const listener = page.listener();
    const sources = page.sources();
    const values = page.values();
    const now = [this.sound.playing, listener, sources, values, this.state.profile, this.state.waves].join();
    if (now === this.stood) return;
    this.stood = now;
    this.sound.stand({
      names: page.value_names(),
      values: values.filter((_, index) => index % 3 === 0),
      seconds: page.seconds(),
      listener,
      source: sources.slice(0, 3),
      profile: this.state.profile,
      waves: this.state.waves,
    });
  }

  // What the button does: starts the sound, stops it, or goes on with it.
  async playOrStop() {
    $("play").disabled = true;
    try {
      if (!this.sound) {
        await this.start();
      } else if (this.sound.isRunning()) {
        await this.sound.stop();
      } else {
        // The ears were not told where one went meanwhile.
        this.stood = "";
        await this.sound.goOn();
      }
      this.messages.say("sound", "");
    } catch (error) {
      this.messages.say("sound", `There is no sound: ${error.message}.`);
    }
    $("play").disabled = false;
    this.showPlay();
  }

  async start() {
    this.sound = await Sound.start((part, data) => this.told(part, data));
    this.sound.context.onstatechange = () => this.showPlay();
    this.hasEars = true;
    this.messages.say("ears", "");
    this.showListen();
    this.stood = "";
    this.play(this.shown);
    this.hear();
  }

  // What a part of the sound says.
  told(part, data) {
    if (data.failed) this.fail(part, data.failed);
    if (data.trouble !== undefined) this.messages.say(part, data.trouble);
    if (data.levels) {
      this.levels = data.levels;
      this.gaps = data.gaps;
    }
    if (data.sources) {
      this.sources = data.sources;
      this.times = { trace: data.trace, late: data.late };
    }
  }

  // A part of the sound has ended: without ears there is still the balance, without the others nothing.
  fail(part, why) {
    if (part === "ears") {
      this.hasEars = false;
      this.sources = [];
      this.messages.say("ears", `Only the balance can be heard, nothing in full: ${why}.`);
      this.showListen();
      this.hear();
      return;
    }
    if (!this.sound) return;
    this.sound.context.onstatechange = null;
    this.sound.close();
    this.sound = null;
    this.forget();
    this.messages.say("mix", "");
    this.messages.say("sound", `The sound has ended: ${why}.`);
    this.showPlay();
  }

  // Nothing can be chosen that cannot be heard.
  showListen() {
    if (!this.hasEars) this.state.listen = "balance";
    for (const option of $("listen").options) {
      option.disabled = option.value === "full" && !this.hasEars;
    }
    $("listen").value = this.state.listen;
  }

  showPlay() {
    $("play").textContent = this.sound?.isRunning() ? "Stop sound" : "Play sound";
  }
}
