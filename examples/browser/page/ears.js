// A worker with a canvas of its own: traces what is heard in full, and tells the mix.

import init, { EarsOfPage } from "./pkg/echomarch_browser.js";

// Milliseconds from one look at the scene to the next at the least.
const LEAST = 4;
// Milliseconds until it looks again where nothing came.
const IDLE = 100;

const ready = init();
let ears = null;
let mix = null;
// The number of the scene that the mix plays.
let scene = 0;
// The scene as it stands, and as it stood when it could not be heard.
let latest = null;
let refused = null;
// The look that is due: its timer, and when it is.
let timer = 0;
let next = Infinity;
// Until then the picture has the graphics for itself.
let rested = 0;
// What was last told to be wrong.
let trouble = "";

// Calls a function; what it throws ends the ears, and the page is told why.
function guarded(act) {
  try {
    act();
  } catch (error) {
    fail(error.message);
  }
}

function fail(why) {
  ears = null;
  postMessage({ failed: why });
}

function begin(data) {
  mix = data.mix;
  const canvas = typeof OffscreenCanvas === "undefined" ? null : new OffscreenCanvas(1, 1);
  const gl = canvas?.getContext("webgl2", { antialias: false, depth: false, alpha: false });
  if (!gl) throw new Error("this browser has no WebGL 2 in workers");
  canvas.addEventListener("webglcontextlost", () => fail("the graphics driver has taken the ears' context away"));
  ears = new EarsOfPage(gl, data.rate);
  mix.onmessage = ({ data: played }) => guarded(() => follow(played));
}

function follow(played) {
  if (!ears) return;
  ears.set_scene(played.text, played.name);
  scene = played.scene;
  refused = null;
  due(0);
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
  if (!ears || !latest || latest === refused) return;
  if (latest.scene !== scene || latest.profile === "thesis") return;
  const began = performance.now();
  let count = 0;
  try {
    count = hear();
    tellTrouble("");
  } catch (error) {
    // Until something changes it would fail again.
    refused = latest;
    tellTrouble(`The ears hear as before: ${error.message}`);
  }
  const now = performance.now();
  // It rests as long as it has looked: the picture needs the graphics too.
  rested = now + (count > 0 ? Math.max(LEAST, now - began) : LEAST);
  // A late part that was not due may be by then.
  due(IDLE);
}

// Traces what is heard of each source, and tells the mix; of how many something has changed.
function hear() {
  const { names, values, seconds, listener, source, profile, waves } = latest;
  const all = ears.hear(names, values, seconds, listener, source, profile, waves);
  for (const heard of all) {
    tell(heard);
  }
  if (all.length > 0) {
    const [trace, late] = ears.milliseconds();
    postMessage({ sources: Array.from(ears.sources()), trace, late });
  }
  return all.length;
}

// Tells the mix what is heard of one source.
function tell(heard) {
  const echoes = heard.echoes;
  const late = heard.late;
  const buffers = late ? [echoes.buffer, late.buffer] : [echoes.buffer];
  mix.postMessage({ scene, source: heard.source, echoes, late, glide: heard.glide_s }, buffers);
  heard.free();
}

// Tells the page once what is wrong, and that it is no more.
function tellTrouble(text) {
  if (text === trouble) return;
  trouble = text;
  postMessage({ trouble });
}

async function take(data) {
  try {
    await ready;
  } catch (error) {
    fail(error.message);
    return;
  }
  guarded(() => {
    if (data.mix) {
      begin(data);
    } else if (ears) {
      latest = data;
      due(LEAST);
    }
  });
}

onmessage = ({ data }) => take(data);
