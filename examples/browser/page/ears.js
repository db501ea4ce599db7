// A worker with a canvas of its own: traces what is heard in full, and tells the mix.

import init, { EarsOfPage } from "./pkg/echomarch_browser.js";

// Of the time that a look takes it rests as long where the processor draws: the picture wants it too.
const REST = 1;
// Milliseconds from one look at the scene to the next at the least.
const LEAST = 4;

const ready = init();
let ears = null, mix, scene = 0, latest = null, isDue = false;

function begin({ rate, mix: port }) {
  mix = port;
  const canvas = typeof OffscreenCanvas === "undefined" ? null : new OffscreenCanvas(1, 1);
  const gl = canvas?.getContext("webgl2", { antialias: false, depth: false, alpha: false });
  if (!gl) throw new Error("this browser has no WebGL 2 in workers: the balance alone can be heard");
  ears = new EarsOfPage(gl, rate);
  mix.onmessage = ({ data }) => {
    ears.set_scene(data.text, data.name);
    scene = data.scene;
    due(0);
  };
}

function due(milliseconds) {
  if (isDue) return;
  isDue = true;
  setTimeout(() => {
    isDue = false;
    look();
  }, milliseconds);
}

function look() {
  if (!latest || latest.scene !== scene || latest.profile === "thesis") return;
  const began = performance.now();
  try {
    const { names, values, seconds, listener, source, profile, waves } = latest;
    const heard = ears.hear(names, values, seconds, listener, source, profile, waves);
    for (const each of heard) {
      const [echoes, late] = [each.echoes, each.late];
      const buffers = late ? [echoes.buffer, late.buffer] : [echoes.buffer];
      mix.postMessage({ scene, source: each.source, echoes, late, glide: each.glide_s }, buffers);
      each.free();
    }
    const [trace, lateMs] = ears.milliseconds();
    postMessage({ sources: Array.from(ears.sources()), trace, late: lateMs, trouble: null });
  } catch (error) {
    postMessage({ trouble: error.message });
  }
  // A late part that was not due may be by then.
  due(Math.max(LEAST, REST * (performance.now() - began)));
}

onmessage = async ({ data }) => {
  await ready;
  try {
    if (data.mix) begin(data);
    else if (ears) {
      latest = data;
      due(LEAST);
    }
  } catch (error) {
    postMessage({ failed: error.message });
  }
};
