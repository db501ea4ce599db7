// The page's sound. This class starts and stops the sound, sends the choices and the state of the scene to the workers,
// and stores the messages of the workers.

import { COMPUTING } from "./panel.js";
import { Sound, prepareEars } from "./sound.js";

// Level in decibels when no sound is played.
const SILENCE_DB = -120;
// Longest time that the page's waves wait for the first response of a scene, in milliseconds: as long as a response with
// few waves usually takes on a software renderer.
const ALONE_MS = 2000;

// Delay until the page says that shaders are compiled, and interval between two updates of the time, in milliseconds. A
// browser that has kept the shaders needs less.
const COMPILES_MS = 400;
const TOLD_MS = 1000;

const $ = (id) => document.getElementById(id);

// The least level of a source in decibels; NaN if it is off.
function leastOf(choice) {
  return choice === "off" ? NaN : Number(choice);
}

export class Listening {
  // Creates the sound for a page (Page) and its choices. Nothing is played yet.
  constructor(page, state, messages) {
    this.page = page;
    this.state = state;
    this.messages = messages;
    this.sound = null;
    // The scene on display: the last valid text.
    this.shown = null;
    // Whether full listening is available.
    this.hasEars = true;
    this.gaps = 0;
    // Whether the scene is heard: a response or the pan of its balance is played.
    this.isHeard = false;
    // Whether waves of the scene were traced.
    this.isTraced = false;
    // The time at which the scene was given to the sound.
    this.began = 0;
    // The timer of the message that shaders are compiled.
    this.compiling = 0;
    // The last state of the scene that was sent to the ears.
    this.stood = "";
    this.forget();
  }

  // Resets the levels, sources and times.
  forget() {
    this.levels = [SILENCE_DB, SILENCE_DB];
    this.limited = 0;
    this.forgetSources();
    this.times = { trace: NaN, late: NaN };
  }

  // Removes what was heard from the sources: three numbers and a text per source, and the exact paths.
  forgetSources() {
    this.sources = [];
    this.texts = [];
    this.paths = [];
  }

  // Whether the choices select full listening.
  isFull() {
    return this.hasEars && this.state.listen === "full" && this.state.profile !== "thesis";
  }

  // Plays the given scene now, or when the user starts the sound.
  play(shown) {
    this.shown = shown;
    // The sources belong to the previous scene.
    this.forgetSources();
    this.isHeard = false;
    this.isTraced = false;
    this.began = performance.now();
    this.showPlay();
    this.sound?.play(shown.text, shown.name, this.state.sound);
    this.prepare();
  }

  // Lets the ears trace the scene before the sound is started.
  prepare() {
    if (this.sound || !this.isFull() || this.state.profile === "thesis") return;
    prepareEars({ ...this.shown, standing: this.standing() });
  }

  // Whether the ears trace the first waves of a scene.
  isAwaited() {
    return Boolean(this.sound?.isRunning()) && this.isFull() && !this.isTraced;
  }

  // Whether the page's waves wait for the ears, because both share the graphics card.
  isComputing() {
    return this.isAwaited() && performance.now() - this.began < ALONE_MS;
  }

  // Sends the choices to the mix.
  hear() {
    // Before the first frame of waves the pan is unknown, and the balance is silent.
    const pan = this.page.frame()[5] ?? NaN;
    this.sound?.listen(this.isFull() ? "full" : "balance", this.state.volume, this.state.profile, pan);
  }

  // Sends the state of the scene to the ears, if the state has changed.
  stand() {
    if (!this.sound?.isListening() || !this.isFull()) return;
    const page = this.page;
    const listener = page.listener();
    const sources = page.sources();
    const values = page.values();
    const now = [this.sound.playing, listener, sources, values, this.state.profile, this.state.waves,
      JSON.stringify(this.state.parts), this.state.least].join();
    if (now === this.stood) return;
    this.stood = now;
    this.sound.stand(this.standing());
  }

  // The state of the scene for the ears.
  standing() {
    const page = this.page;
    return {
      names: page.value_names(),
      values: page.values().filter((_, index) => index % 4 === 0),
      seconds: page.seconds(),
      listener: page.listener(),
      source: page.sources().slice(0, 3),
      profile: this.state.profile,
      waves: this.state.waves,
      parts: { ...this.state.parts, least: leastOf(this.state.least) },
    };
  }

  // The button's action: starts the sound, stops it, or resumes it.
  async playOrStop() {
    $("play").disabled = true;
    try {
      if (!this.sound) {
        $("play").textContent = "Computing…";
        await this.start();
      } else if (this.sound.isRunning()) {
        await this.sound.stop();
      } else {
        // The ears have missed all changes since the sound was stopped.
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

  // Handles a message from a part of the sound (ears, mix or player).
  told(part, data) {
    if (data.failed) this.fail(part, data.failed);
    if (data.compiles !== undefined) this.showCompiling(data.compiles);
    if (data.trouble !== undefined) this.messages.say(part, data.trouble);
    if (data.levels) {
      this.levels = data.levels;
      this.gaps = data.gaps;
    }
    if (data.heard !== undefined) {
      this.limited = data.limited;
      if (data.heard !== this.isHeard) {
        this.isHeard = data.heard;
        this.showPlay();
      }
    }
    if (data.sources && data.scene === this.sound?.sent) {
      this.isTraced = !data.isSketch;
      this.sources = data.sources;
      const isLateOpen = data.isSketch && this.state.parts.late;
      this.texts = data.texts.map((text) => (isLateOpen ? `${text}, late part ${COMPUTING}` : text));
      this.paths = data.paths;
      this.times = { trace: data.trace, late: data.late };
    }
  }

  // Handles the failure of a part of the sound. Without the ears only the balance is played; without the mix or the
  // player there is no sound.
  fail(part, why) {
    this.showCompiling(false);
    if (part === "ears") {
      this.hasEars = false;
      this.forgetSources();
      this.messages.say("ears", `Only the balance can be heard, without full listening: ${why}.`);
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

  // Disables choices that cannot be heard.
  showListen() {
    if (!this.hasEars) this.state.listen = "balance";
    for (const option of $("listen").options) {
      option.disabled = option.value === "full" && !this.hasEars;
    }
    $("listen").value = this.state.listen;
  }

  // Says that the ears compile shaders, and for how many seconds; false removes the message.
  showCompiling(compiles) {
    clearTimeout(this.compiling);
    $("compiling").hidden = true;
    if (!compiles) return;
    const began = performance.now();
    const show = () => {
      const seconds = Math.round((performance.now() - began) / 1000);
      $("compiling").textContent = `Compiling shaders for the sound … ${seconds} s`;
      $("compiling").hidden = false;
      this.compiling = setTimeout(show, TOLD_MS);
    };
    this.compiling = setTimeout(show, COMPILES_MS);
  }

  showPlay() {
    const isRunning = this.sound?.isRunning() ?? false;
    const isSilent = isRunning && !this.isHeard;
    $("play").textContent = isSilent ? "Computing…" : isRunning ? "Stop sound" : "Play sound";
    $("play").setAttribute("aria-busy", String(isSilent));
  }
}
