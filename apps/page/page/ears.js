// A worker with its own canvas, which traces full listening and sends the responses to the mix.

import init, { EarsOfPage } from "./pkg/echomarch_browser.js";

// Minimum interval between two traces, in milliseconds.
const LEAST = 4;
// Time until the next trace if no message arrives, in milliseconds.
const IDLE = 100;

const ready = init();
let ears = null;
let mix = null;
// The number of the scene that the mix plays.
let scene = 0;
// The current state of the scene, and the last state that could not be traced.
let latest = null;
let refused = null;
// The scene to trace before the sound is started.
let toPrepare = null;
// The next scheduled trace: its timer and its time.
let timer = 0;
let next = Infinity;
// End of the pause during which only the picture uses the graphics card.
let rested = 0;
// The last error reported.
let trouble = "";
// Whether the next trace is the first one of a scene, which compiles its shaders.
let isFirst = false;
// Whether the sound that needs no waves is due before the first trace of a scene.
let isSketchDue = false;

// Calls a function. An exception ends this worker's tracing, and its message is sent to the page.
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

// Opens a context for the ears.
function open() {
  const canvas = typeof OffscreenCanvas === "undefined" ? null : new OffscreenCanvas(1, 1);
  const gl = canvas?.getContext("webgl2", { antialias: false, depth: false, alpha: false });
  if (!gl) throw new Error("this browser has no WebGL 2 in workers");
  canvas.addEventListener("webglcontextlost", () => fail("the graphics driver has discarded the context for full listening"));
  ears = new EarsOfPage(gl);
}

// Traces the last scene that was sent before the sound is started, so that its programs are compiled and its gain is
// known. A failure is reported when the sound starts.
function prepare() {
  const { text, name, standing } = toPrepare;
  toPrepare = null;
  if (mix) return;
  try {
    if (!ears) open();
    setScene(text, name);
    trace(standing).forEach((heard) => heard.free());
  } catch {
    ears = null;
  }
}

function begin(data) {
  mix = data.mix;
  if (!ears) open();
  ears.set_rate(data.rate);
  mix.onmessage = ({ data: played }) => guarded(() => follow(played));
}

function follow(played) {
  if (!ears) return;
  setScene(played.text, played.name);
  scene = played.scene;
  refused = null;
  due(0);
}

// Schedules a trace after a delay, unless an earlier one is scheduled. The trace never starts before the end of the
// pause.
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
    // The trace would fail again until the scene changes.
    refused = latest;
    tellTrouble(`Full listening is unchanged: ${error.message}`);
  }
  const now = performance.now();
  // Pauses for the duration of the trace, because the picture needs the graphics card too.
  rested = now + (count > 0 ? Math.max(LEAST, now - began) : LEAST);
  // A late part that is not due now may be due at the next trace.
  due(IDLE);
}

function setScene(text, name) {
  ears.set_scene(text, name);
  isFirst = true;
  isSketchDue = true;
}

// Returns the changed responses of the sources in a state of the scene. A sketch needs no waves.
function respond({ names, values, seconds, listener, source, profile, waves, parts }, isSketch) {
  ears.set_parts(parts.diffraction, parts.transmission, parts.mirrored, parts.late, parts.least);
  return ears.hear(names, values, seconds, listener, source, profile, waves, isSketch);
}

// Traces each source in a state of the scene. Returns the changed responses. A message to the page says when shaders are compiled.
function trace(standing) {
  const compiles = isFirst;
  isFirst = false;
  if (compiles) postMessage({ compiles });
  try {
    return respond(standing, false);
  } finally {
    if (compiles) postMessage({ compiles: false });
  }
}

// Sends the changes of the sources to the mix: first what needs no waves, so that a new scene is heard at once. Returns the
// number of changed sources that were traced.
function hear() {
  if (isSketchDue) {
    isSketchDue = false;
    if (tellAll(respond(latest, true), true) > 0) return 0;
  }
  return tellAll(trace(latest), false);
}

// Sends responses to the mix, and their summary to the page. Returns their number.
function tellAll(all, isSketch) {
  for (const heard of all) {
    tell(heard);
  }
  if (all.length > 0) {
    const [trace, late] = ears.milliseconds();
    postMessage({ scene, isSketch, sources: Array.from(ears.sources()), texts: ears.source_texts(), paths: ears.paths(),
      trace, late });
  }
  return all.length;
}

// Sends the response of one source to the mix.
function tell(heard) {
  const echoes = heard.echoes;
  const late = heard.late;
  const buffers = late ? [echoes.buffer, late.buffer] : [echoes.buffer];
  mix.postMessage({ scene, source: heard.source, echoes, late, gain: heard.gain, glide: heard.glide_s }, buffers);
  heard.free();
}

// Reports an error to the page once. An empty text reports that the error is resolved.
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
    if (data.prepare) {
      if (!toPrepare) setTimeout(prepare);
      toPrepare = data.prepare;
    } else if (data.mix) {
      begin(data);
    } else if (ears) {
      latest = data;
      due(LEAST);
    }
  });
}

onmessage = ({ data }) => take(data);
