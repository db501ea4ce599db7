// A worker that mixes the sound into blocks of samples when the player requests them.

import init, { MixOfPage } from "./pkg/echomarch_browser.js";

const ready = init();
let rate = 0;
let player = null;
let ears = null;
let mix = null;
// The number of the scene that is played.
let playing = 0;
let choices = { listen: "full", volume: 0.5, profile: "hybrid", pan: NaN };
// Frames since the last report to the page, and the number of frames between two reports: a tenth of a second.
let told = 0;
const toldEvery = () => rate / 10;
// Responses that the mix could not accept yet, by source. These responses are passed to the mix after the next block.
const waiting = new Map();

// Calls a function. An exception ends the sound, and its message is sent to the page.
function guarded(act) {
  try {
    act();
  } catch (error) {
    postMessage({ failed: error.message });
  }
}

function choose() {
  if (!mix) return;
  mix.set_listen(choices.listen);
  mix.set_volume(choices.volume);
  mix.set_pan(choices.profile, choices.pan);
}

function block(frames) {
  const samples = mix ? mix.fill(frames) : new Float32Array(2 * frames);
  player.postMessage(samples, [samples.buffer]);
  report(frames);
  for (const [source, heard] of waiting) {
    if (!tell(heard)) break;
    waiting.delete(source);
  }
}

// Reports to the page whether the scene is heard, and how much the limiter attenuates, in decibels.
function report(frames) {
  told += frames;
  if (!mix || told < toldEvery()) return;
  told = 0;
  postMessage({ heard: mix.is_heard(), limited: mix.limited_db() });
}

function tell(heard) {
  return mix.hear(heard.source, heard.echoes, heard.late, heard.gain, heard.glide);
}

function hear(heard) {
  // Responses of the previous scene are discarded.
  if (heard.scene !== playing) return;
  const before = waiting.get(heard.source);
  // If the new response has no late part, the late part of the waiting response is still needed.
  if (before && !heard.late) heard.late = before.late;
  if (before || !tell(heard)) waiting.set(heard.source, heard);
}

function begin(data) {
  rate = data.rate;
  player = data.player;
  ears = data.ears;
  player.onmessage = ({ data: frames }) => guarded(() => block(frames));
  ears.onmessage = ({ data: heard }) => guarded(() => hear(heard));
}

// Plays a scene. If that fails, the previous scene continues. Tells the page which scene plays.
function play({ scene, text, name, sound }) {
  let trouble = "";
  try {
    if (mix) {
      mix.set_scene(text, name, sound);
    } else {
      mix = new MixOfPage(text, name, sound, rate);
    }
    playing = scene;
    waiting.clear();
    choose();
    // The ears get the scene from the mix, so that no response arrives before the mix can play it.
    ears.postMessage({ scene, text, name });
  } catch (error) {
    trouble = `The sound is unchanged: ${error.message}`;
  }
  postMessage({ answered: scene, playing, trouble });
}

async function take(data) {
  try {
    await ready;
  } catch (error) {
    postMessage({ failed: error.message });
    return;
  }
  guarded(() => {
    if (data.player) {
      begin(data);
    } else if (data.text !== undefined) {
      play(data);
    } else {
      choices = data;
      choose();
    }
  });
}

onmessage = ({ data }) => take(data);
