// A worker with a canvas of its own: traces what is heard in full, and tells the mix.

import init, { EarsOfPage } from "./pkg/echomarch_browser.js";

// It rests so long after each look, of the time that this took: the picture wants the graphics too.
const REST = 1;
// Milliseconds from one look at the scene to the next at the least.
const LEAST = 4;
// Milliseconds until it looks again where nothing came.
const IDLE = 100;

const ready = init();
let ears = null, mix, scene = 0, latest = null, timer = 0, next = Infinity, rested = 0;

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

// Looks after so long, if that is not to be sooner; never before the rest is over.
function due(milliseconds) {
  const when = Math.max(performance.now() + milliseconds, rested);
  if (when >= next) return;
  clearTimeout(timer);
  next = when;
  timer = setTimeout(() => {
    next = Infinity;
    look();
  }, when - performance.now());
}

function look() {
  if (!latest || latest.scene !== scene || latest.profile === "thesis") return;
  const began = performance.now();
  let count = 0;
  try {
    const { names, values, seconds, listener, source, profile, waves } = latest;
    const heard = ears.hear(names, values, seconds, listener, source, profile, waves);
    count = heard.length;
    heard.forEach(tell);
    if (count) {
      const [trace, late] = ears.milliseconds();
      postMessage({ sources: Array.from(ears.sources()), trace, late, trouble: null });
    }
  } catch (error) {
    postMessage({ trouble: error.message });
  }
  const now = performance.now();
  rested = now + (count ? Math.max(LEAST, REST * (now - began)) : LEAST);
  // A late part that was not due may be by then.
  due(IDLE);
}

// Tells the mix what is heard of one source.
function tell(heard) {
  const [echoes, late] = [heard.echoes, heard.late];
  const buffers = late ? [echoes.buffer, late.buffer] : [echoes.buffer];
  mix.postMessage({ scene, source: heard.source, echoes, late, glide: heard.glide_s }, buffers);
  heard.free();
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
