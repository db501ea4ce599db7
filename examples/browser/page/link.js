// The link that holds the settings: everything after the # of the address.

// What is not in a link is as here.
export const usual = {
  scene: "open-pillars", profile: "hybrid", waves: 65536, iterations: 8, listen: "full", sound: "speech",
  volume: 0.5, text: null, listener: null, source: null, values: {},
};

const numbers = (text, count) => {
  const all = (text ?? "").split(",").map(Number);
  return all.length === count && all.every(Number.isFinite) ? all : null;
};

// The settings of a link; what it lacks or what is no number is as usual.
export function read(fragment) {
  const said = new URLSearchParams(fragment.replace(/^#/, ""));
  const number = (name) => {
    const value = Number(said.get(name) ?? NaN);
    return Number.isFinite(value) ? value : usual[name];
  };
  const values = {};
  for (const [name, value] of said) {
    if (name.startsWith("value.") && Number.isFinite(Number(value))) values[name.slice(6)] = Number(value);
  }
  return {
    scene: said.get("scene") ?? usual.scene,
    profile: said.get("profile") ?? usual.profile,
    waves: number("waves"),
    iterations: number("iterations"),
    listen: said.get("listen") ?? usual.listen,
    sound: said.get("sound") ?? usual.sound,
    volume: number("volume"),
    text: said.get("text"),
    listener: numbers(said.get("listener"), 5),
    source: numbers(said.get("source"), 3),
    values,
  };
}

const short = (all) => Array.from(all, (number) => Number(number.toFixed(3))).join(",");

// The link of these settings.
export function write(settings) {
  const said = new URLSearchParams();
  for (const name of ["scene", "profile", "waves", "iterations", "listen", "sound", "volume"]) {
    said.set(name, settings[name]);
  }
  for (const [name, value] of Object.entries(settings.values)) said.set(`value.${name}`, value);
  if (settings.listener) said.set("listener", short(settings.listener));
  if (settings.source) said.set("source", short(settings.source));
  if (settings.text !== null) said.set("text", settings.text);
  return `#${said}`;
}
