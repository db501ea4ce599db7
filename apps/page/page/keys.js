// Keys and mouse, as in the window (docs/demo.md). Keys are identified by their position on the keyboard.

const HELD = {
  KeyW: [0, 1], KeyS: [0, -1], KeyD: [1, 1], KeyA: [1, -1], KeyE: [2, 1], KeyQ: [2, -1],
  ArrowRight: [3, 1], ArrowLeft: [3, -1], ArrowUp: [4, 1], ArrowDown: [4, -1],
};

// Radians per pixel of mouse movement.
const MOUSE = 0.0025;

const types = (element) => element.closest?.("input, select, textarea") != null;

// Listens to keys and mouse. `on` maps key codes to the actions of single presses; `look` takes angles in radians.
export function listenTo(canvas, on, look) {
  // The keys that are down, with the time until which the walk has followed them, in milliseconds.
  const down = new Map();
  // The keys that were down since the last picture, and the longest time for which one of them was. Pictures may be
  // seconds apart while shaders are compiled, and a key may be pressed and released between two of them.
  const pressed = new Set();
  let held = 0;
  const release = (code, time) => {
    if (down.has(code)) held = Math.max(held, time - down.get(code));
    down.delete(code);
  };
  addEventListener("keydown", (event) => {
    if (types(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (HELD[event.code] || on[event.code]) event.preventDefault();
    if (!event.repeat) on[event.code]?.();
    if (!down.has(event.code)) down.set(event.code, event.timeStamp);
    pressed.add(event.code);
  });
  addEventListener("keyup", (event) => release(event.code, event.timeStamp));
  addEventListener("blur", () => down.clear());
  canvas.addEventListener("click", (event) => {
    canvas.focus();
    // A finger turns the gaze by dragging.
    if (event.pointerType === "touch" || event.pointerType === "pen") return;
    if (document.pointerLockElement) document.exitPointerLock();
    // The browser may refuse the pointer lock, for example just after the last lock ended. The mouse then does not
    // rotate the gaze.
    else canvas.requestPointerLock()?.catch?.(() => {});
  });
  addEventListener("mousemove", (event) => {
    if (document.pointerLockElement === canvas) look(MOUSE * event.movementX, -MOUSE * event.movementY);
  });
  return {
    // Forward, right, up, turn, tilt (−1 to 1) since the last call, and how long a key was held since then, in
    // milliseconds.
    moves() {
      const now = performance.now();
      for (const [code, since] of down) {
        held = Math.max(held, now - since);
        down.set(code, now);
      }
      const moves = new Float32Array(5);
      for (const code of new Set([...down.keys(), ...pressed])) if (HELD[code]) moves[HELD[code][0]] += HELD[code][1];
      const took = held;
      pressed.clear();
      held = 0;
      return { moves, held: took };
    },
    get runs() {
      return down.has("ShiftLeft") || down.has("ShiftRight");
    },
  };
}
