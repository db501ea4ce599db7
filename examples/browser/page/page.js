// The page: a walk through a scene, what is heard in it, and the choices.

import init, { Page, scene_text, scenes } from "./pkg/echomarch_browser.js";
import { listenTo } from "./keys.js";
import * as link from "./link.js";
import { Plan } from "./plan.js";
import { Sound } from "./sound.js";

// Milliseconds of a picture that waves are traced for.
const WAVES_MS = 8;
// Pictures from one plan to the next.
const PLAN_EVERY = 6;
// Milliseconds from one picture to the next that are held: more makes the picture coarser, less finer.
const HELD_MS = [22, 40];
// Shares of the canvas' size that the picture is drawn at.
const SCALES = [0.15, 0.2, 0.3, 0.4, 0.55, 0.75, 1];
// Milliseconds until a text that is being written is read, and until a change is in the link.
const WRITTEN_MS = 400;
const LINKED_MS = 500;
// Numbers of waves that can be chosen.
const WAVES = Array.from({ length: 11 }, (_, power) => 1024 << power);

const $ = (id) => document.getElementById(id);
const canvas = $("picture");
const state = { ...link.usual, source: null };
let page, plan, keys, sound = null, levels = [-120, -120], gaps = 0, heardInFull = [], earTimes = [NaN, NaN];
let scale = 2, pictures = 0, last = performance.now(), between = 30, ways = new Float32Array();
let spent = { waves: 0, picture: 0, plan: 0 }, linked = 0, stood = "";

function say(text) {
  $("message").textContent = text;
  $("message").hidden = !text;
}

// Why the page cannot work, if it cannot.
function lacking(gl) {
  if (!gl) return "This page needs WebGL 2, which this browser does not have or has switched off.";
  if (!gl.getExtension("EXT_color_buffer_float")) {
    return "This page needs the WebGL extension EXT_color_buffer_float (drawing into textures of floats), which this graphics driver does not have.";
  }
  return null;
}

const builtIn = () => scene_text(state.scene) ?? "";
const text = () => state.text ?? builtIn();

// Reads the text as the scene; says why not, and leaves all as it was, where it is none.
function take() {
  try {
    page.set_scene(text(), state.scene);
    showError("");
    playAgain();
    showValues();
    return true;
  } catch (error) {
    showError(error.message);
    return false;
  }
}

function showError(message) {
  $("error").textContent = message;
  $("error").hidden = !message;
  if (message) $("editor").open = true;
}

function playAgain() {
  stood = "";
  sound?.play(text(), state.scene, state.sound);
}

function trace() {
  try {
    page.set_settings(state.profile, state.waves, state.iterations);
    say("");
  } catch (error) {
    say(error.message);
  }
}

// A scene that was chosen; where it stays the same only its text is read again.
function change(to) {
  Object.assign(state, to);
  if (take()) {
    if (state.text === null) $("text").value = builtIn();
  }
}

// All that a link says.
function follow(fragment) {
  const said = link.read(fragment);
  const known = scenes().includes(said.scene);
  Object.assign(state, said, { scene: known ? said.scene : link.usual.scene });
  for (const name of ["scene", "profile", "iterations", "listen", "sound", "volume"]) $(name).value = state[name];
  if (!WAVES.includes(state.waves)) $("waves").add(new Option(state.waves, state.waves));
  $("waves").value = state.waves;
  $("text").value = text();
  trace();
  if (take()) {
    for (const [name, value] of Object.entries(state.values)) setValue(name, value);
    if (state.listener) page.stand(...state.listener);
    if (state.source) page.put_source(...state.source);
    showValues();
  }
  if (!known) say(`There is no scene "${said.scene}": ${state.scene} is shown.`);
  hear();
}

function setValue(name, value) {
  try {
    page.set_value(name, value);
    state.values[name] = value;
  } catch (error) {
    say(error.message);
  }
}

// A slider for each named value of the scene.
function showValues() {
  const [names, numbers] = [page.value_names(), page.values()];
  const rows = names.map((name, index) => {
    const [value, least, most] = numbers.slice(3 * index, 3 * index + 3);
    const [label, slider] = [document.createElement("label"), document.createElement("input")];
    Object.assign(slider, { type: "range", min: least, max: most, step: (most - least) / 200, value });
    slider.oninput = () => setValue(name, Number(slider.value));
    label.append(name, slider);
    return label;
  });
  $("values").replaceChildren(...rows);
}

// Tells the sound what is listened to.
function hear() {
  const pan = page.frame()[5] ?? 0;
  const listen = state.profile === "thesis" ? "balance" : state.listen;
  sound?.listen(listen, state.volume, state.profile, pan);
}

async function startSound() {
  if (sound) {
    const stopped = sound.context.state === "running";
    await (stopped ? sound.context.suspend() : sound.context.resume());
    $("play").textContent = stopped ? "Play sound" : "Stop sound";
    return;
  }
  $("play").disabled = true;
  try {
    sound = await Sound.start(told);
    $("play").textContent = "Stop sound";
    playAgain();
    hear();
  } catch (error) {
    say(`no sound: ${error.message}`);
  }
  $("play").disabled = false;
}

// What the sound's workers say.
function told(data) {
  if (data.failed) {
    say(data.failed);
    [state.listen, $("listen").value] = ["balance", "balance"];
    hear();
  }
  if (data.trouble !== undefined && data.trouble !== null) say(data.trouble);
  if (data.levels) [levels, gaps] = [data.levels, data.gaps];
  if (data.sources) [heardInFull, earTimes] = [data.sources, [data.trace, data.late]];
}

// Sends the scene as it stands to the ears, if it has changed.
function stand() {
  if (!sound || state.listen !== "full") return;
  const listener = page.listener();
  const sources = page.sources();
  const values = page.values();
  const standing = {
    names: page.value_names(),
    values: values.filter((_, index) => index % 3 === 0),
    seconds: page.seconds(), listener, source: sources.slice(0, 3), profile: state.profile, waves: state.waves,
  };
  const now = [sound.scene, listener, sources, values, state.profile, state.waves].join();
  if (now === stood) return;
  stood = now;
  sound.stand(standing);
}

function picture(now) {
  const passed = now - last;
  last = now;
  between += 0.1 * (passed - between);
  page.pass(keys.moves(), keys.runs, passed / 1000);
  const began = performance.now();
  if (page.trace(WAVES_MS)) hear();
  const traced = performance.now();
  resize();
  const isNew = page.draw(canvas.width, canvas.height, SCALES[scale]);
  const drawn = performance.now();
  if (pictures % PLAN_EVERY === 0) drawPlan();
  spent = { waves: traced - began, picture: drawn - traced, plan: performance.now() - drawn };
  stand();
  if (pictures % PLAN_EVERY === 0) show();
  if (isNew && pictures % 20 === 0) adapt();
  if (now - linked > LINKED_MS) writeLink(now);
  pictures += 1;
}

function loop(now) {
  try {
    picture(now);
    requestAnimationFrame(loop);
  } catch (error) {
    say(`The page has stopped: ${error.message}`);
  }
}

function resize() {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * devicePixelRatio)));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
}

function drawPlan() {
  const seen = page.plan();
  ways = page.ways();
  plan.draw(seen, ways, page.listener(), page.radius(), page.sources());
  seen.free();
}

// Coarser where pictures come too slowly, finer where there is time.
function adapt() {
  if (between > HELD_MS[1]) scale = Math.max(0, scale - 1);
  else if (between < HELD_MS[0]) scale = Math.min(SCALES.length - 1, scale + 1);
}

function show() {
  const frame = page.frame();
  if (frame.length) {
    const [hits, dead, travelling, , , pan] = frame;
    [$("hits").textContent, $("dead").textContent, $("travelling").textContent] = [hits, dead, travelling];
    $("pan").textContent = pan.toFixed(3);
  }
  [$("left").value, $("right").value] = levels;
  const told = [];
  for (let i = 0; i < heardInFull.length; i += 3) {
    const [level, paths, direct] = heardInFull.slice(i, i + 3);
    told.push(Number.isNaN(level) ? "nothing arrives" : `G ${level.toFixed(1)} dB, ${paths} paths${direct ? "" : ", hidden"}`);
  }
  $("full").textContent = state.listen === "full" && state.profile !== "thesis" && sound ? told.join("; ") || "–" : "–";
  const row = (name, value) => `<tr><th>${name}</th><td>${Number.isFinite(value) ? value.toFixed(1) : "–"} ms</td></tr>`;
  $("times").innerHTML = row("from picture to picture", between) + row("waves, until they are heard", frame[6]) +
    row("calls: waves", spent.waves) + row("calls: picture", spent.picture) + row("plan and paths", spent.plan) +
    row("heard in full: trace", earTimes[0]) + row("heard in full: late part", earTimes[1]) +
    `<tr><th>gaps in the sound</th><td>${gaps}</td></tr>`;
  $("size").textContent = `${canvas.width} × ${canvas.height}, at ${Math.round(100 * SCALES[scale])} % while anything moves`;
}

// The link of what is chosen and where one stands.
function address() {
  return link.write({ ...state, listener: page.listener(), source: state.source });
}

function writeLink(now) {
  linked = now;
  const to = address();
  if (to !== location.hash) history.replaceState(null, "", to);
}

function connect() {
  for (const name of scenes()) $("scene").add(new Option(name, name));
  for (const waves of WAVES) $("waves").add(new Option(waves, waves));
  $("scene").onchange = (event) => {
    change({ scene: event.target.value, text: null, source: null, values: {} });
    canvas.focus();
  };
  const traced = (name, of) => ($(name).onchange = (event) => {
    state[name] = of(event.target.value);
    trace();
    hear();
  });
  traced("profile", String);
  traced("waves", Number);
  traced("iterations", Number);
  traced("listen", String);
  $("sound").onchange = (event) => {
    state.sound = event.target.value;
    playAgain();
  };
  $("volume").oninput = (event) => {
    state.volume = Number(event.target.value);
    hear();
  };
  $("play").onclick = startSound;
  let waiting = 0;
  $("text").oninput = () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      const written = $("text").value;
      state.text = written === builtIn() ? null : written;
      take();
    }, WRITTEN_MS);
  };
  addEventListener("hashchange", () => follow(location.hash));
}

// What a key asks for once.
const asked = {
  KeyF() {
    page.pick_up_or_put_down();
    state.source = Array.from(page.sources().slice(0, 3));
  },
  KeyP: () => page.pause_or_go_on(),
  Space: () => page.pause_or_go_on(),
  Home: () => startOver(),
  Backspace: () => startOver(),
  KeyV: () => choose("listen", state.listen === "full" ? "balance" : "full"),
  Digit1: () => choose("profile", "thesis"),
  Digit2: () => choose("profile", "march"),
  Digit3: () => choose("profile", "hybrid"),
  BracketLeft: () => choose("waves", Math.max(WAVES[0], state.waves / 2)),
  BracketRight: () => choose("waves", Math.min(WAVES.at(-1), state.waves * 2)),
  Comma: () => choose("iterations", Math.max(1, state.iterations - 1)),
  Period: () => choose("iterations", state.iterations + 1),
};

function startOver() {
  page.start_over();
  state.source = null;
}

function choose(name, value) {
  $(name).value = value;
  $(name).dispatchEvent(new Event("change"));
}

async function begin() {
  const gl = canvas.getContext("webgl2", { antialias: false, depth: false, alpha: false });
  const why = lacking(gl);
  if (why) return say(why);
  canvas.addEventListener("webglcontextlost", () => say("The graphics driver has taken the context away: load the page again."));
  await init();
  page = new Page(gl, scene_text(link.usual.scene), link.usual.scene);
  plan = new Plan($("plan"));
  keys = listenTo(canvas, asked, (right, up) => page.look(right, up));
  connect();
  $("renderer").textContent = page.renderer();
  follow(location.hash);
  canvas.focus();
  requestAnimationFrame(loop);
  // For tests and for whoever looks closer at it.
  window.echomarch = { page, state, sound: () => sound, levels: () => levels, address };
}

begin().catch((error) => say(`The page cannot start: ${error.message}`));
