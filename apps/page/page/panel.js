// The panel beside the plan: levels, sources and durations.

const $ = (id) => document.getElementById(id);

// Takes the place of figures of a new scene until they are known.
export const COMPUTING = "computing …";

// Returns a row of the table of times, with milliseconds to one decimal.
function row(name, milliseconds) {
  const value = Number.isFinite(milliseconds) ? milliseconds.toFixed(1) : "–";
  return `<tr><th>${name}</th><td>${value} ms</td></tr>`;
}

// Shows the counts and the pan of the last frame. `frame` is empty before the first frame of a scene.
export function showFrame(frame) {
  const [hits, dead, travelling, , , pan] = frame;
  $("hits").textContent = hits ?? COMPUTING;
  $("dead").textContent = dead ?? "–";
  $("travelling").textContent = travelling ?? "–";
  $("pan").textContent = pan?.toFixed(3) ?? "–";
}

// Level in decibels below which the played pan is not shown.
const SILENT_DB = -60;
const played = { pan: null };

// Shows the played levels of both channels in decibels, the pan that has these levels by the law of constant power, and
// the attenuation by the limiter in decibels. During pauses of the sound the last pan stays.
export function showLevels(levels, limited) {
  const [left, right] = levels.map((level) => 10 ** (level / 20));
  if (Math.max(...levels) > SILENT_DB) played.pan = Math.atan2(right, left) / (Math.PI / 4) - 1;
  $("played").textContent = played.pan?.toFixed(3) ?? "–";
  $("limiter").textContent = limited > 0 ? `−${limited.toFixed(1)} dB` : "rests";
  $("limiter").classList.toggle("limits", limited > 0);
  $("left").value = levels[0];
  $("right").value = levels[1];
}

// Shows the sources of full listening with their names: three numbers per source, as EarsOfPage.sources returns them, and
// the paths by kind, or why nothing arrives, as EarsOfPage.source_texts returns them. `isAwaited` says that they are computed.
export function showSources(sources, texts, names, isAwaited) {
  const told = [];
  for (let i = 0; i < sources.length; i += 3) {
    const [level, paths, direct] = sources.slice(i, i + 3);
    if (Number.isNaN(level)) {
      told.push(`${names[i / 3]}: nothing arrives`);
    } else {
      told.push(`${names[i / 3]}: G ${level.toFixed(1)} dB, ${paths} paths${direct ? "" : ", hidden"}`);
    }
  }
  $("full").textContent = told.join("; ") || (isAwaited ? COMPUTING : "–");
  const lines = texts.length > 1 ? texts.map((text, index) => `${names[index]}: ${text}`) : texts;
  $("kinds").textContent = lines.join("\n") || "–";
}

// Shows the durations in milliseconds (between pictures, of a frame of waves, of calls, of the ears), and the number of
// gaps in the sound.
export function showTimes(times) {
  $("times").innerHTML = row("from picture to picture", times.between) +
    row("waves, until they are heard", times.frame) +
    row("calls: waves", times.waves) +
    row("calls: picture", times.picture) +
    row("plan and paths", times.plan) +
    row("heard in full: trace", times.ears) +
    row("heard in full: late part", times.late) +
    `<tr><th>gaps in the sound</th><td>${times.gaps}</td></tr>`;
}
