// The link stores the settings: everything after the # of the address.

// Defaults of the settings that a link omits.
export const usual = {
  scene: "open-pillars", profile: "hybrid", waves: 65536, iterations: 8, listen: "full", sound: "speech",
  volume: 0.5, least: "off", motion: "on",
  parts: { diffraction: false, transmission: true, mirrored: true, late: true },
  text: null, listener: null, source: null, values: {},
};

// The allowed range of each number.
export const LIMITS = {
  waves: { least: 1, most: 1048576, isWhole: true },
  iterations: { least: 1, most: 64, isWhole: true },
  volume: { least: 0, most: 1, isWhole: false },
};

// How many numbers a position has: x, y, z, and for the listener also the yaw and pitch of the gaze.
const PLACES = { listener: 5, source: 3 };

// The values of a switch.
const SWITCHED = ["off", "on"];

// Prefix of the names of values.
const VALUE = "value.";

function numberOf(text) {
  return text.trim() === "" ? NaN : Number(text);
}

// Returns the reason why a setting cannot have this number; "" if the number is valid.
export function wrongNumber(name, value) {
  const { least, most, isWhole } = LIMITS[name];
  const isWithin = value >= least && value <= most;
  if (isWithin && (!isWhole || Number.isInteger(value))) return "";
  return `${name} has to be a ${isWhole ? "whole " : ""}number from ${least} to ${most}`;
}

// Whether a number is still finite after conversion to 32 bits, as the program stores it.
function isNumber(value) {
  return Number.isFinite(Math.fround(value));
}

// Reads a link. `choices` has the allowed names of each setting. `wrong` in the result has a sentence for each invalid
// entry of the link. The setting of an invalid entry gets its default.
export function read(fragment, choices) {
  const settings = { ...usual, parts: { ...usual.parts }, values: {} };
  const wrong = [];
  const entries = new URLSearchParams(fragment.replace(/^#/, ""));
  for (const [name, value] of entries) {
    // A text may have any name.
    const isOwnName = name === "scene" && entries.has("text");
    if (isOwnName) settings.scene = value;
    const why = isOwnName ? "" : set(settings, name, value, choices);
    if (why) wrong.push(why);
  }
  return { settings, wrong };
}

// Applies one entry of a link. Returns the reason if the entry is invalid.
function set(settings, name, value, choices) {
  if (name === "text") {
    settings.text = value;
    return "";
  }
  if (name === "motion") {
    if (!SWITCHED.includes(value)) return `motion has to be on or off, not "${value}": it is ignored`;
    settings.motion = value;
    return "";
  }
  if (Object.hasOwn(choices, name)) {
    if (!choices[name].includes(value)) return `there is no ${name} "${value}": ${usual[name]} is used`;
    settings[name] = value;
    return "";
  }
  if (Object.hasOwn(usual.parts, name)) {
    if (!SWITCHED.includes(value)) return `${name} has to be on or off, not "${value}": it is ignored`;
    settings.parts[name] = value === "on";
    return "";
  }
  if (Object.hasOwn(LIMITS, name)) {
    const why = wrongNumber(name, numberOf(value));
    if (why) return `${why}, not "${value}": ${usual[name]} is used`;
    settings[name] = numberOf(value);
    return "";
  }
  if (Object.hasOwn(PLACES, name)) {
    const numbers = value.split(",").map(numberOf);
    const isPlace = numbers.length === PLACES[name] && numbers.every(isNumber);
    if (!isPlace) return `${name} has to be ${PLACES[name]} numbers, not "${value}": it is ignored`;
    settings[name] = numbers;
    return "";
  }
  if (name.startsWith(VALUE)) {
    if (!isNumber(numberOf(value))) return `${name} has to be a number, not "${value}": it is ignored`;
    settings.values[name.slice(VALUE.length)] = numberOf(value);
    return "";
  }
  return `there is no setting "${name}": it is ignored`;
}

function short(numbers) {
  return Array.from(numbers, (number) => Number(number.toFixed(3))).join(",");
}

// Returns the link for these settings.
export function write(settings) {
  const said = new URLSearchParams();
  for (const name of ["scene", "profile", "waves", "iterations", "listen", "sound", "volume", "least", "motion"]) {
    said.set(name, settings[name]);
  }
  for (const [name, isOn] of Object.entries(settings.parts)) {
    said.set(name, SWITCHED[Number(isOn)]);
  }
  for (const [name, value] of Object.entries(settings.values)) {
    said.set(VALUE + name, value);
  }
  if (settings.listener) said.set("listener", short(settings.listener));
  if (settings.source) said.set("source", short(settings.source));
  if (settings.text !== null) said.set("text", settings.text);
  return `#${said}`;
}
