// The plan: the scene from above, with source, listener, and paths of waves.

// Line styles by the status of a wave: dead, travelling, at the listener.
const STYLES = [
  { colour: "#28be9573", width: 0.8 },
  { colour: "#96a0aa38", width: 0.8 },
  { colour: "#ff802c", width: 1.4 },
];

// Colours of the kinds of exact paths, and the width of their lines in CSS pixels. The page's legend has the same
// colours.
const KINDS = { direct: "#f5f5f5", mirrored: "#f0e442", diffracted: "#f064c8", transmitted: "#968cff" };
const EXACT_WIDTH = 1.6;
// Opacity of the paths of waves beside exact paths.
const BESIDE_EXACT = 0.35;

// Maximum height of the plan, in CSS pixels.
const MOST_HEIGHT = 250;

// Height of the texts in the plan, in CSS pixels.
const TEXT = 11;

export class Plan {
  // `kinds` are the names of the kinds of exact paths, as path_kinds returns them.
  constructor(canvas, kinds) {
    this.canvas = canvas;
    this.kinds = kinds;
    this.image = document.createElement("canvas");
  }

  // Draws the plan. `plan` is a PlanOfPage; `ways` and `paths` are the arrays of numbers that Page.ways and
  // EarsOfPage.paths return. `marks` has the listener (x, y, z, yaw, pitch), the positions of the sources and of the
  // other listeners, three numbers each, and the names of both; the names of the listeners begin with the walker's.
  draw(plan, ways, paths, marks) {
    if (plan.rgba.length) {
      this.image.width = plan.width;
      this.image.height = plan.height;
      const pixels = new ImageData(new Uint8ClampedArray(plan.rgba), plan.width, plan.height);
      this.image.getContext("2d").putImageData(pixels, 0, 0);
    }
    const [left, top, right, bottom] = plan.bounds;
    const room = this.canvas.parentElement.clientWidth;
    const shown = Math.min(room / (right - left), MOST_HEIGHT / (bottom - top));
    const scale = shown * devicePixelRatio;
    const width = Math.max(1, Math.round((right - left) * scale));
    const height = Math.max(1, Math.round((bottom - top) * scale));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.canvas.style.width = `${width / devicePixelRatio}px`;
    }
    const to = this.canvas.getContext("2d");
    to.drawImage(this.image, 0, 0, width, height);
    const at = (x, z) => [(x - left) * scale, (z - top) * scale];
    to.globalAlpha = paths.length > 0 ? BESIDE_EXACT : 1;
    this.ways(to, ways, at);
    to.globalAlpha = 1;
    this.paths(to, paths, at);
    this.marks(to, at, scale, marks);
    this.texts(to, at, scale, marks);
  }

  ways(to, ways, at) {
    for (const fate of [0, 1, 2]) {
      to.strokeStyle = STYLES[fate].colour;
      to.lineWidth = STYLES[fate].width * devicePixelRatio;
      this.lines(to, ways, at, (of) => of === fate);
    }
  }

  // Draws the exact paths: mirrored paths first, the others on top.
  paths(to, paths, at) {
    to.lineWidth = EXACT_WIDTH * devicePixelRatio;
    for (const name of ["mirrored", "direct", "transmitted", "diffracted"]) {
      to.strokeStyle = KINDS[name];
      this.lines(to, paths, at, (kind) => this.kinds[kind] === name);
    }
  }

  // Draws lines from an array of numbers: for each line its class, the number of points, and the x and z of each point.
  // `isDrawn` selects classes.
  lines(to, numbers, at, isDrawn) {
    for (let i = 0; i < numbers.length; ) {
      const of = numbers[i];
      const points = numbers[i + 1];
      i += 2;
      if (isDrawn(of)) {
        to.beginPath();
        for (let p = 0; p < points; p++) to.lineTo(...at(numbers[i + 2 * p], numbers[i + 2 * p + 1]));
        to.stroke();
      }
      i += 2 * points;
    }
  }

  marks(to, at, scale, { listener: [x, , z, yaw], radius, sources, others }) {
    const dot = (place, size, colour) => {
      to.beginPath();
      to.arc(...place, size, 0, 2 * Math.PI);
      to.fillStyle = colour;
      to.fill();
    };
    const one = devicePixelRatio;
    for (let i = 0; i < others.length; i += 3) dot(at(others[i], others[i + 2]), 3 * one, "#56b4e966");
    const place = at(x, z);
    const size = Math.max(radius * scale, 3 * one);
    dot(place, size, "#56b4e940");
    to.beginPath();
    to.moveTo(...place);
    to.lineTo(place[0] + Math.sin(yaw) * (size + 9 * one), place[1] - Math.cos(yaw) * (size + 9 * one));
    to.strokeStyle = "#56b4e9";
    to.lineWidth = 2 * one;
    to.stroke();
    dot(place, 3 * one, "#56b4e9");
    for (let i = 0; i < sources.length; i += 3) {
      dot(at(sources[i], sources[i + 2]), 6.5 * one, "#f0b0284d");
      dot(at(sources[i], sources[i + 2]), 3.5 * one, "#f0b028");
    }
  }

  // Names sources and listeners, and draws a bar of a round length in metres. No two texts overlap.
  texts(to, at, scale, { listener, sources, others, sourceNames, listenerNames }) {
    const one = devicePixelRatio;
    to.font = `${TEXT * one}px system-ui, sans-serif`;
    to.textBaseline = "middle";
    const { width, height } = this.canvas;
    const length = roundLength((0.3 * width) / scale);
    const bar = [6 * one, height - 6 * one, length * scale];
    const text = `${length} m`;
    to.fillStyle = "#d6dce2";
    to.fillRect(bar[0], bar[1] - one, bar[2], 2 * one);
    const taken = [{ x: bar[0], y: bar[1] - (TEXT + 6) * one, width: Math.max(bar[2], to.measureText(text).width),
      height: (TEXT + 7) * one }];
    to.fillText(text, bar[0], bar[1] - (TEXT / 2 + 3) * one);
    const positions = [];
    for (let i = 0; i < sources.length; i += 3) positions.push([at(sources[i], sources[i + 2]), sourceNames[i / 3]]);
    positions.push([at(listener[0], listener[2]), listenerNames[0]]);
    for (let i = 0; i < others.length; i += 3) positions.push([at(others[i], others[i + 2]), listenerNames[i / 3 + 1]]);
    // Marks are kept free too.
    for (const [[x, y]] of positions) taken.push({ x: x - 5 * one, y: y - 5 * one, width: 10 * one, height: 10 * one });
    this.named = [];
    for (const [[x, y], name] of positions) {
      const box = free(x, y, to.measureText(name).width, TEXT * one, 9 * one, taken, [width, height]);
      if (!box) continue;
      taken.push(box);
      this.named.push({ name, ...box });
      to.fillStyle = "#10141ab0";
      to.fillRect(box.x - one, box.y, box.width + 2 * one, box.height);
      to.fillStyle = "#d6dce2";
      to.fillText(name, box.x, box.y + box.height / 2);
    }
  }
}

// Returns the first free box for a text beside a mark: right, left, above, below; null if all four are taken.
function free(x, y, width, height, beside, taken, [most, lowest]) {
  const places = [[x + beside, y - height / 2], [x - beside - width, y - height / 2],
    [x - width / 2, y - beside - height], [x - width / 2, y + beside]];
  const isFree = (box) => box.x >= 0 && box.y >= 0 && box.x + width <= most && box.y + height <= lowest &&
    taken.every((other) => !overlap(box, other));
  return places.map(([left, top]) => ({ x: left, y: top, width, height })).find(isFree) ?? null;
}

function overlap(a, b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

// The largest of 1, 2 or 5 times a power of ten that is at most `most`.
function roundLength(most) {
  const ten = 10 ** Math.floor(Math.log10(most));
  const factor = [5, 2, 1].find((times) => times * ten <= most) ?? 1;
  return Number((factor * ten).toPrecision(3));
}
