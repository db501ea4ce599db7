// The link that holds the settings: everything after the # of the address.

// What is not in a link is as here.
export const usual = {
  scene: "open-pillars", profile: "hybrid", waves: 65536, iterations: 8, listen: "full", sound: "speech",
  volume: 0.5, text: null, listener: null, source: null, values: {},
};

// What a number may be.
export const LIMITS = {
  waves: { least: 1, most: 1048576, isWhole: true },
  iterations: { least: 1, most: 64, isWhole: true },
  volume: { least: 0, most: 1, isWhole: false },
};

// How many numbers a place has: x, y, z, and where the listener looks.
const PLACES = { listener: 5, source: 3 };

// How names of values begin.
const VALUE = "value.";

function numberOf(text) {
  return text.trim() === "" ? NaN : Number(text);
}

// Why a setting cannot be that number; nothing where it can.
export function wrongNumber(name, value) {
  const { least, most, isWhole } = LIMITS[name];
  const isWithin = value >= least && value <= most;
  if (isWithin && (!isWhole || Number.isInteger(value))) return "";
  return `${name} has to be a ${isWhole ? "whole " : ""}number from ${least} to ${most}`;
}

// Whether a number is one in the program too, which has 32 bits for it.
function isNumber(value) {
  return Number.isFinite(Math.fround(value));
}

// Reads a link. `choices` has the names that can be chosen, by setting. `wrong` of the answer has a sentence for each
// thing that the link says and that cannot be; that is as usual then.
export function read(fragment, choices) {
  const settings = { ...usual, values: {} };
  const wrong = [];
  for (const [name, value] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    const why = set(settings, name, value, choices);
    if (why) wrong.push(why);
  }
  return { settings, wrong };
}

// Sets one thing that a link says; why not, if it cannot be.
function set(settings, name, value, choices) {
  if (name === "text") {
    settings.text = value;
    return "";
  }
  if (Object.hasOwn(choices, name)) {
    if (!choices[name].includes(value)) return `there is no ${name} "${value}": ${usual[name]} is taken`;
    settings[name] = value;
    return "";
  }
  if (Object.hasOwn(LIMITS, name)) {
    const why = wrongNumber(name, numberOf(value));
    if (why) return `${why}, not "${value}": ${usual[name]} is taken`;
    settings[name] = numberOf(value);
    return "";
  }
  if (Object.hasOwn(PLACES, name)) {
    const numbers = value.split(",").map(numberOf);
    const isPlace = numbers.length === PLACES[name] && numbers.every(isNumber);
    if (!isPlace) return `${name} has to be ${PLACES[name]} numbers, not "${value}": it is left out`;
    settings[name] = numbers;
    return "";
  }
  if (name.startsWith(VALUE)) {
    if (!isNumber(numberOf(value))) return `${name} has to be a number, not "${value}": it is left out`;
    settings.values[name.slice(VALUE.length)] = numberOf(value);
    return "";
  }
  return `there is no setting "${name}": it is left out`;
}

function short(numbers) {
  return Array.from(numbers, (number) => Number(number.toFixed(3))).join(",");
}

// The link of these settings.
export function write(settings) {
  const said = new URLSearchParams();
  for (const name of ["scene", "profile", "waves", "iterations", "listen", "sound", "volume"]) {
    said.set(name, settings[name]);
  }
  for (const [name, value] of Object.entries(settings.values)) {
    said.set(VALUE + name, value);
  }
  if (settings.listener) said.set("listener", short(settings.listener));
  if (settings.source) said.set("source", short(settings.source));
  if (settings.text !== null) said.set("text", settings.text);
  return `#${said}`;
}
