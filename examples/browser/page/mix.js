// A worker: mixes what is heard into blocks, as the player asks for them.

import init, { MixOfPage } from "./pkg/echomarch_browser.js";

const ready = init();
let rate, player, ears, mix = null, scene = 0;
let choices = { listen: "full", volume: 0.5, profile: "hybrid", pan: 0 };
let trouble = null;

function choose() {
  mix?.set_listen(choices.listen);
  mix?.set_volume(choices.volume);
  mix?.set_pan(choices.profile, choices.pan);
}

function block(frames) {
  const samples = mix ? mix.fill(frames) : new Float32Array(2 * frames);
  player.postMessage(samples, [samples.buffer]);
}

function begin(data) {
  ({ rate, player, ears } = data);
  player.onmessage = ({ data: frames }) => block(frames);
  // What was heard of a scene before this one is of no use.
  ears.onmessage = ({ data: heard }) => {
    if (heard.scene === scene) mix?.hear(heard.source, heard.echoes, heard.late, heard.glide);
  };
}

function play({ scene: number, text, name, sound }) {
  try {
    const next = new MixOfPage(text, name, sound, rate);
    mix?.free();
    [mix, scene] = [next, number];
    choose();
    // The ears are told by this way, so that they say nothing of it before there is something to play it.
    ears.postMessage({ scene, text, name });
    trouble = null;
  } catch (error) {
    trouble = error.message;
  }
  postMessage({ trouble });
}

onmessage = async ({ data }) => {
  await ready;
  if (data.player) begin(data);
  else if (data.text !== undefined) play(data);
  else {
    choices = { ...choices, ...data };
    choose();
  }
};
