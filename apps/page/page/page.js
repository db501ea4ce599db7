// The page: a walk through a scene, its sound, and the choices.

import init, { Page, path_kinds, scene_name, scene_text, scenes } from "./pkg/echomarch_browser.js";
import { listenToScrolling, showError, showLines, showWarnings } from "./editor.js";
import { listenTo } from "./keys.js";
import * as link from "./link.js";
import { Listening } from "./listening.js";
import { Messages } from "./messages.js";
import { OwnScenes } from "./own.js";
import { showFrame, showLevels, showSources, showTimes } from "./panel.js";
import { Plan } from "./plan.js";
import { prepare } from "./sound.js";
import { listenToTouch } from "./touch.js";

// Time spent on tracing waves in each picture, in milliseconds.
const WAVES_MS = 8;
// Number of pictures between two updates of the plan.
const PLAN_EVERY = 6;
// Number of pictures between two changes of the picture's scale.
const ADAPT_EVERY = 20;
// Target range of the interval between pictures, in milliseconds. Above it the picture's scale is reduced; below it the
// scale is raised.
const SHORT_MS = 22;
const LONG_MS = 40;
// Maximum time that passes in the scene between two pictures, in milliseconds. The limit prevents a jump after a delay.
const LONGEST_MS = 250;
// Maximum time for which a key walks between two pictures, in milliseconds.
const MOST_HELD_MS = 1000;
// The ratios of the picture's resolution to the canvas' that can be chosen.
const SCALES = [0.15, 0.2, 0.3, 0.4, 0.55, 0.75, 1];
// Delay from the last keystroke to the reading of the text, and interval between updates of the link, in milliseconds.
const WRITTEN_MS = 400;
const LINKED_MS = 500;
// Delay before the next attempt after a picture failed, in milliseconds.
const AGAIN_MS = 500;
// Time for which the button says that the link was copied, in milliseconds.
const COPIED_MS = 2000;
// The numbers of waves to choose from.
const WAVES = Array.from({ length: 11 }, (_, power) => 1024 << power);
// The least level that the key 8 switches on, in decibels.
const LEAST = "-30";
// The first words of a Rust panic message. After a panic the program's state is undefined.
const PANICKED = "panicked at";

const $ = (id) => document.getElementById(id);
const canvas = $("picture");
const messages = new Messages($("message"));

// The choices.
const state = {
  scene: link.usual.scene,
  profile: link.usual.profile,
  waves: link.usual.waves,
  iterations: link.usual.iterations,
  listen: link.usual.listen,
  sound: link.usual.sound,
  volume: link.usual.volume,
  least: link.usual.least,
  parts: { ...link.usual.parts },
  motion: link.usual.motion,
  text: null,
  // The own scene of `text`; null for a built-in scene.
  own: null,
  values: {},
};
let gl = null;
let page = null;
let plan = null;
let keys = null;
let stick = null;
let listening = null;
let ownScenes = null;
// The timer until the written text is read.
let written = 0;
// The times of the last change of the text, and of the last step or turn of the listener.
let editedAt = Infinity;
let walkedAt = -Infinity;

// The number of pictures, the time of the last picture (null after a pause), and the average interval in milliseconds.
let pictures = 0;
let last = null;
let between = 30;
let scale = 2;
// Whether the browser is to paint the panel before the next picture.
let isPaintDue = false;
let spent = { waves: 0, picture: 0, plan: 0 };
let linked = 0;

// Returns the reason why the page cannot work; "" if it can.
function lacking() {
  if (!gl) return "This page needs WebGL 2, which this browser does not have or has switched off.";
  if (!gl.getExtension("EXT_color_buffer_float")) {
    return "This page needs the WebGL extension EXT_color_buffer_float (drawing into textures of floats), " +
      "which this graphics driver does not have.";
  }
  return "";
}

function builtIn() {
  return scene_text(state.scene) ?? "";
}

function text() {
  return state.text ?? builtIn();
}

// Chooses an own scene, or the built-in scene with this name if `own` is null. `take` shows it.
function become(name, own) {
  state.scene = own?.name ?? name;
  state.own = own;
  state.text = own?.text ?? null;
  $("scene").value = state.scene;
}

// Returns the name of the built-in scene with this text; undefined if there is none.
function builtInWith(text) {
  return scenes().find((name) => scene_text(name) === text);
}

// Reads the scene from the text. If the text is invalid, shows the error and leaves everything unchanged. `isAnew`
// restarts the walk even if the scene has the same name.
function take(isAnew) {
  const read = { text: text(), name: state.scene };
  // A place to which the user walked since the text was changed stays, even if the scene has another name.
  const place = !isAnew && walkedAt > editedAt && page.has_walked() ? page.listener() : null;
  try {
    if (isAnew) {
      page.open_scene(read.text, read.name);
    } else {
      page.set_scene(read.text, read.name);
      if (place && !page.has_walked()) standAgain(place);
    }
  } catch (error) {
    showWarnings([]);
    showError(error.message);
    return false;
  }
  if (state.own) {
    ownScenes.rename(state.own, scene_name(state.text));
    become(state.own.name, state.own);
  }
  showError("");
  warn(read);
  showValues();
  listening.play(read);
  // The figures of the previous scene disappear before the next picture, which may take seconds.
  show();
  isPaintDue = true;
  return true;
}

// Takes the listener of a scene that was just opened to a place, unless that is inside a solid of this scene.
function standAgain(place) {
  const before = page.warnings_of_places().length;
  page.stand(...place);
  if (page.warnings_of_places().length > before) page.start_over();
}

// Shows the warnings about the scene that was read. They may take some time, so that the scene is shown first.
function warn(read) {
  showWarnings([]);
  requestAnimationFrame(() => setTimeout(() => {
    if (listening.shown === read) showWarnings(page.warnings_of_shapes());
  }));
}

// Sets the settings for tracing. If that fails, shows the reason and leaves everything unchanged.
function trace(wanted) {
  let why = link.wrongNumber("waves", wanted.waves) || link.wrongNumber("iterations", wanted.iterations);
  try {
    if (!why) page.set_settings(wanted.profile, wanted.waves, wanted.iterations);
  } catch (error) {
    why = error.message;
  }
  if (!why) {
    state.profile = wanted.profile;
    state.waves = wanted.waves;
    state.iterations = wanted.iterations;
  }
  messages.say("settings", why && `The settings are unchanged: ${why}.`);
  showSettings();
  return !why;
}

function showSettings() {
  const waves = $("waves");
  if (!namesOf("waves").includes(String(state.waves))) {
    const larger = Array.from(waves.options).find((option) => Number(option.value) > state.waves);
    waves.add(new Option(state.waves, state.waves), larger ?? null);
  }
  $("profile").value = state.profile;
  waves.value = state.waves;
  $("iterations").value = state.iterations;
}

// Shows the parts of the sound that are heard, and the least level.
function showParts() {
  for (const [name, isOn] of Object.entries(state.parts)) {
    $(name).checked = isOn;
  }
  $("least").value = state.least;
}

function chooseSettings() {
  messages.say("link", "");
  trace({
    profile: $("profile").value,
    waves: Number($("waves").value),
    iterations: Number($("iterations").value),
  });
  listening.hear();
}

// Shows the scene with this name in the list. If a built-in scene cannot be traced, the previous scene stays. The text
// of an own scene is shown even if it is invalid, so that the user can correct it.
function chooseScene(name) {
  messages.say("link", "");
  clearTimeout(written);
  const before = { scene: state.scene, own: state.own, values: state.values };
  const own = ownScenes.named(name);
  become(name, own);
  state.values = {};
  if (own) $("text").value = text();
  if (take(true)) {
    state.motion = "on";
    $("text").value = text();
    showLines();
  } else if (!own) {
    become(before.scene, before.own);
    state.values = before.values;
  }
}

// Returns the option values of a list element.
function namesOf(list) {
  return Array.from($(list).options, (option) => option.value);
}

// Applies all settings of a link, and restarts the walk.
function follow(fragment) {
  const choices = {};
  for (const list of ["profile", "listen", "sound", "least"]) {
    choices[list] = namesOf(list);
  }
  choices.scene = scenes();
  const { settings, wrong } = link.read(fragment, choices);
  clearTimeout(written);
  const isOwn = settings.text !== null && !builtInWith(settings.text);
  const wanted = scenes().includes(settings.scene) ? scene_name(settings.text ?? "") : settings.scene;
  become(builtInWith(settings.text) ?? settings.scene, isOwn ? ownScenes.withText(wanted, settings.text) : null);
  state.values = {};
  state.listen = settings.listen;
  state.sound = settings.sound;
  state.volume = settings.volume;
  state.least = settings.least;
  state.parts = settings.parts;
  state.motion = settings.motion;
  showParts();
  $("sound").value = state.sound;
  $("volume").value = state.volume;
  $("text").value = text();
  listening.showListen();
  // Settings that are invalid for the previous scene may be valid for this one.
  const isSet = trace(settings);
  if (take(true)) {
    if (!isSet) trace(settings);
    // A scene that was opened moves.
    if (state.motion === "off") page.pause_or_go_on();
    stay(settings, wrong);
  }
  messages.say("link", wrong.length > 0 ? `In the link: ${wrong.join("; ")}.` : "");
  listening.hear();
}

// Applies the named values of a link, and its positions of listener and source. Adds the reason for each failure to
// `wrong`.
function stay(settings, wrong) {
  for (const [name, value] of Object.entries(settings.values)) {
    const why = setValue(name, value);
    if (why) wrong.push(why);
  }
  if (settings.listener) page.stand(...settings.listener);
  if (settings.source) page.put_source(...settings.source);
  showValues();
}

// Sets a named value. Returns the reason if that fails.
function setValue(name, value) {
  try {
    page.set_value(name, value);
  } catch (error) {
    return error.message;
  }
  state.values[name] = value;
  return "";
}

// Shows a slider for each named value of the scene.
function showValues() {
  const names = page.value_names();
  const numbers = page.values();
  const rows = names.map((name, index) => {
    const [value, least, most, step] = numbers.slice(4 * index, 4 * index + 4);
    const label = document.createElement("label");
    const slider = document.createElement("input");
    Object.assign(slider, { type: "range", min: least, max: most, step: step || (most - least) / 200, value });
    slider.oninput = () => messages.say("values", setValue(name, Number(slider.value)));
    label.append(name, slider);
    return label;
  });
  $("values").replaceChildren(...rows);
  for (const name of Object.keys(state.values)) {
    if (!names.includes(name)) delete state.values[name];
  }
  messages.say("values", "");
}

// Time since the last picture in milliseconds; 0 for the first picture, and after the page was hidden.
function passedUntil(now) {
  const passed = last === null ? 0 : now - last;
  if (last !== null) between += 0.1 * (passed - between);
  last = now;
  return Math.min(passed, LONGEST_MS);
}

function picture(now) {
  const { moves, held } = keys.moves();
  moves[0] += stick.forward;
  moves[1] += stick.right;
  if (moves.some((move) => move !== 0)) walkedAt = performance.now();
  const passed = passedUntil(now);
  page.pass(moves, keys.runs, passed / 1000);
  // A key that was held while no picture could be drawn still walks.
  const steps = Math.floor(Math.min(held, MOST_HELD_MS) / LONGEST_MS);
  for (let step = 1; step < steps; step++) page.pass(moves, keys.runs, LONGEST_MS / 1000);
  const began = performance.now();
  if (!listening.isComputing() && page.trace(WAVES_MS)) listening.hear();
  const traced = performance.now();
  resize();
  const isNew = page.draw(canvas.width, canvas.height, SCALES[scale]);
  const drawn = performance.now();
  const isPlanDue = pictures % PLAN_EVERY === 0;
  if (isPlanDue) drawPlan();
  spent = { waves: traced - began, picture: drawn - traced, plan: performance.now() - drawn };
  listening.stand();
  if (isPlanDue) show();
  if (isNew && pictures % ADAPT_EVERY === 0) adapt();
  if (now - linked > LINKED_MS) writeLink(now);
  pictures += 1;
}

// Draws a picture and requests the next one. After a failure, it reports the error and tries again later, because the
// scene may have changed by then.
function loop(now) {
  if (gl.isContextLost()) return;
  if (isPaintDue) {
    isPaintDue = false;
    requestAnimationFrame(loop);
    return;
  }
  try {
    picture(now);
    messages.say("picture", "");
    if (pictures === 1) starting("");
  } catch (error) {
    if (gl.isContextLost()) return;
    if (error.message.startsWith(PANICKED)) {
      messages.say("picture", `The page has stopped; reload it: ${error.message}`);
      return;
    }
    messages.say("picture", `This picture cannot be drawn: ${error.message}`);
    setTimeout(() => requestAnimationFrame(loop), AGAIN_MS);
    return;
  }
  requestAnimationFrame(loop);
}

function resize() {
  const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
  const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
  if (canvas.width === width && canvas.height === height) return;
  canvas.width = width;
  canvas.height = height;
}

function drawPlan() {
  const seen = page.plan();
  const paths = listening.isFull() ? listening.paths : [];
  plan.draw(seen, listening.isComputing() ? [] : page.ways(), paths, {
    listener: page.listener(),
    radius: page.radius(),
    sources: page.sources(),
    others: page.other_listeners(),
    sourceNames: page.source_names(),
    listenerNames: page.listener_names(),
  });
  seen.free();
}

// Reduces the picture's scale if the interval between pictures is too long; raises it if there is time to spare.
function adapt() {
  if (between > LONG_MS) {
    scale = Math.max(0, scale - 1);
  } else if (between < SHORT_MS) {
    scale = Math.min(SCALES.length - 1, scale + 1);
  }
}

function show() {
  const frame = page.frame();
  showFrame(frame);
  showLevels(listening.levels, listening.limited);
  const isFull = listening.isFull();
  showSources(isFull ? listening.sources : [], isFull ? listening.texts : [], page.source_names(),
    listening.isAwaited());
  messages.say("places", page.warnings_of_places().join("\n"));
  const { trace, late } = listening.times;
  showTimes({ ...spent, between, frame: frame[6], ears: trace, late, gaps: listening.gaps });
  $("pause").textContent = state.motion === "on" ? "pause" : "go on";
  const share = Math.round(100 * SCALES[scale]);
  $("size").textContent = `${canvas.width} × ${canvas.height}, at ${share} % while anything moves`;
}

// Returns the link for the choices. The link includes the positions of listener and source if the user has changed
// them.
function address() {
  const placed = page.placed_source();
  return link.write({
    ...state,
    listener: page.has_walked() ? page.listener() : null,
    source: placed.length > 0 ? placed : null,
  });
}

function writeLink(now) {
  linked = now;
  const to = address();
  if (to !== location.hash) history.replaceState(null, "", to);
}

// Copies the link, or shows it where a browser forbids to copy.
async function copyLink() {
  const to = new URL(address(), location.href).href;
  try {
    await navigator.clipboard.writeText(to);
    $("copy").textContent = "Link copied";
    setTimeout(() => ($("copy").textContent = "Copy link"), COPIED_MS);
  } catch {
    prompt("The link to this scene:", to);
  }
}

function connect() {
  for (const name of scenes()) {
    $("scene").add(new Option(name, name));
  }
  ownScenes = new OwnScenes($("scene"));
  for (const waves of WAVES) {
    $("waves").add(new Option(waves, waves));
  }
  $("scene").onchange = (event) => {
    chooseScene(event.target.value);
    canvas.focus();
  };
  $("profile").onchange = chooseSettings;
  $("waves").onchange = chooseSettings;
  $("iterations").onchange = chooseSettings;
  $("listen").onchange = (event) => {
    state.listen = event.target.value;
    listening.hear();
  };
  $("sound").onchange = (event) => {
    state.sound = event.target.value;
    listening.play(listening.shown);
  };
  $("volume").oninput = (event) => {
    state.volume = Number(event.target.value);
    listening.hear();
  };
  for (const name of Object.keys(state.parts)) {
    $(name).onchange = (event) => {
      state.parts[name] = event.target.checked;
    };
  }
  $("least").onchange = (event) => {
    state.least = event.target.value;
  };
  $("copy").onclick = copyLink;
  $("play").onclick = () => listening.playOrStop();
  $("size-of-text").onchange = (event) => {
    document.querySelector("aside").style.zoom = event.target.value;
  };
  listenToScrolling();
  $("text").oninput = () => {
    editedAt = performance.now();
    showLines();
    keepWritten();
    clearTimeout(written);
    written = setTimeout(() => take(false), WRITTEN_MS);
  };
  addEventListener("hashchange", () => follow(location.hash));
  // While the page is hidden, it draws no pictures, and no time passes in its scene.
  document.addEventListener("visibilitychange", () => {
    last = null;
  });
}

// Keeps the written text as an own scene. The text of a built-in scene is never kept as one.
function keepWritten() {
  const edited = $("text").value;
  let own = state.own;
  const builtIn = builtInWith(edited);
  if (builtIn) {
    if (own) ownScenes.remove(own);
    own = null;
  } else if (own) {
    ownScenes.change(own, edited);
  } else {
    own = ownScenes.add(scene_name(edited), edited);
  }
  become(builtIn, own);
}

// The actions of single key presses.
const asked = {
  KeyF: () => page.pick_up_or_put_down(),
  KeyP: pauseOrGoOn,
  Space: pauseOrGoOn,
  Home: () => page.start_over(),
  Backspace: () => page.start_over(),
  KeyV: () => {
    if (listening.hasEars) choose("listen", state.listen === "full" ? "balance" : "full");
  },
  Digit4: () => $("diffraction").click(),
  Digit5: () => $("transmission").click(),
  Digit6: () => $("mirrored").click(),
  Digit7: () => $("late").click(),
  Digit8: () => choose("least", state.least === "off" ? LEAST : "off"),
  Digit1: () => choose("profile", "thesis"),
  Digit2: () => choose("profile", "march"),
  Digit3: () => choose("profile", "hybrid"),
  BracketLeft: () => choose("waves", WAVES.findLast((waves) => waves < state.waves) ?? state.waves),
  BracketRight: () => choose("waves", WAVES.find((waves) => waves > state.waves) ?? state.waves),
  Comma: () => choose("iterations", Math.max(link.LIMITS.iterations.least, state.iterations - 1)),
  Period: () => choose("iterations", Math.min(link.LIMITS.iterations.most, state.iterations + 1)),
};

// Shows buttons for the keys that a touch screen lacks.
function connectButtons() {
  for (const button of document.querySelectorAll("[data-key]")) {
    button.onclick = () => asked[button.dataset.key]();
  }
}

function pauseOrGoOn() {
  page.pause_or_go_on();
  state.motion = state.motion === "on" ? "off" : "on";
}

function choose(name, value) {
  $(name).value = value;
  $(name).dispatchEvent(new Event("change"));
}

// Shows what the page does before its first picture; "" if nothing. The text is visible when the result is resolved.
function starting(text) {
  $("starting").textContent = text;
  $("starting").hidden = !text;
  return new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
}

async function begin() {
  gl = canvas.getContext("webgl2", { antialias: false, depth: false, alpha: false });
  const why = lacking();
  if (why) {
    messages.say("page", why);
    return;
  }
  canvas.addEventListener("webglcontextlost", () => {
    messages.say("picture", "The graphics driver has discarded the WebGL context: reload the page.");
  });
  starting("Loading …");
  await init();
  await starting("Compiling shaders …");
  page = new Page(gl, builtIn(), state.scene);
  listening = new Listening(page, state, messages);
  listening.play({ text: builtIn(), name: state.scene });
  plan = new Plan($("plan"), path_kinds());
  const look = (right, up) => {
    walkedAt = performance.now();
    page.look(right, up);
  };
  keys = listenTo(canvas, asked, look);
  stick = listenToTouch(canvas, $("stick"), look);
  connect();
  connectButtons();
  $("renderer").textContent = page.renderer();
  // The first scene stands still until P is pressed.
  follow(location.hash || "#motion=off");
  // A page that embeds this one keeps the focus, and its place.
  if (window.top === window) canvas.focus();
  requestAnimationFrame(loop);
  prepare((data) => listening.told("ears", data));
  listening.prepare();
  // Access for tests and for the browser's console.
  window.echomarch = { page, state, sound: () => listening.sound, levels: () => listening.levels,
    paths: () => listening.paths, isHeard: () => listening.isHeard, named: () => plan.named, address };
}

begin().catch((error) => {
  starting("");
  messages.say("page", `The page cannot start: ${error.message}`);
});
