// The plan: the scene from above, with source, listener, and paths of waves.

// Line styles by the status of a wave: dead, travelling, at the listener.
const STYLES = [
  { colour: "#28be9573", width: 0.8 },
  { colour: "#96a0aa38", width: 0.8 },
  { colour: "#ff802c", width: 1.4 },
];

// Maximum height of the plan, in CSS pixels.
const MOST_HEIGHT = 250;

export class Plan {
  constructor(canvas) {
    this.canvas = canvas;
    this.image = document.createElement("canvas");
  }

  // Draws the plan. `plan` is a PlanOfPage; `ways` is the array of numbers that Page.ways returns.
  draw(plan, ways, listener, radius, sources) {
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
    this.ways(to, ways, at);
    this.marks(to, at, scale, listener, radius, sources);
  }

  ways(to, ways, at) {
    for (const fate of [0, 1, 2]) {
      to.strokeStyle = STYLES[fate].colour;
      to.lineWidth = STYLES[fate].width * devicePixelRatio;
      for (let i = 0; i < ways.length; ) {
        const of = ways[i];
        const points = ways[i + 1];
        i += 2;
        if (of === fate) {
          to.beginPath();
          for (let p = 0; p < points; p++) to.lineTo(...at(ways[i + 2 * p], ways[i + 2 * p + 1]));
          to.stroke();
        }
        i += 2 * points;
      }
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
