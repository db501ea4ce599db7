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

export class Plan {
  // `kinds` are the names of the kinds of exact paths, as path_kinds returns them.
  constructor(canvas, kinds) {
    this.canvas = canvas;
    this.kinds = kinds;
    this.image = document.createElement("canvas");
  }

  // Draws the plan. `plan` is a PlanOfPage; `ways` and `paths` are the arrays of numbers that Page.ways and
  // EarsOfPage.paths return.
  draw(plan, ways, paths, listener, radius, sources) {
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
    this.marks(to, at, scale, listener, radius, sources);
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

  marks(to, at, scale, [x, , z, yaw], radius, sources) {
    const dot = (place, size, colour) => {
      to.beginPath();
      to.arc(...place, size, 0, 2 * Math.PI);
      to.fillStyle = colour;
      to.fill();
    };
    const one = devicePixelRatio;
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
}
