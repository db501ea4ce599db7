// The panel beside the plan: levels, sources and durations.

const $ = (id) => document.getElementById(id);

// Returns a row of the table of times, with milliseconds to one decimal.
function row(name, milliseconds) {
  const value = Number.isFinite(milliseconds) ? milliseconds.toFixed(1) : "–";
  return `<tr><th>${name}</th><td>${value} ms</td></tr>`;
}

// Shows the counts and the pan of the last frame. `frame` is empty before the first frame of a scene.
export function showFrame(frame) {
  const [hits, dead, travelling, , , pan] = frame;
  $("hits").textContent = hits ?? "–";
  $("dead").textContent = dead ?? "–";
  $("travelling").textContent = travelling ?? "–";
  $("pan").textContent = pan?.toFixed(3) ?? "–";
}

// Shows the played levels of both channels, in decibels.
export function showLevels(levels) {
  $("left").value = levels[0];
  $("right").value = levels[1];
}

// Shows the sources of full listening: three numbers per source, as EarsOfPage.sources returns them, and the paths by
// kind, as EarsOfPage.source_texts returns them.
export function showSources(sources, texts) {
  const told = [];
  for (let i = 0; i < sources.length; i += 3) {
    const [level, paths, direct] = sources.slice(i, i + 3);
    if (Number.isNaN(level)) {
      told.push("nothing arrives");
    } else {
      told.push(`G ${level.toFixed(1)} dB, ${paths} paths${direct ? "" : ", hidden"}`);
    }
  }
  $("full").textContent = told.join("; ") || "–";
  $("kinds").textContent = texts.join("; ") || "–";
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
