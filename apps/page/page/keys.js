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
  const down = new Set();
  addEventListener("keydown", (event) => {
    if (types(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (HELD[event.code] || on[event.code]) event.preventDefault();
    if (!event.repeat) on[event.code]?.();
    down.add(event.code);
  });
  addEventListener("keyup", (event) => down.delete(event.code));
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
    // Forward, right, up, turn, tilt: −1 to 1.
    moves() {
      const moves = new Float32Array(5);
      for (const code of down) if (HELD[code]) moves[HELD[code][0]] += HELD[code][1];
      return moves;
    },
    get runs() {
      return down.has("ShiftLeft") || down.has("ShiftRight");
    },
  };
}
