// Touch: a finger on the picture turns the gaze, a finger on the stick walks.

// Radians per CSS pixel of a drag.
const DRAG = 0.005;

// Removes the hint, which names the gestures, once one of them was made.
function hideHint() {
  document.getElementById("touch").hidden = true;
}

// Listens to fingers and pens. `look` takes angles in radians. The result has the moves of the stick: forward and right,
// −1 to 1.
export function listenToTouch(canvas, stick, look) {
  if (matchMedia("(any-pointer: coarse)").matches || navigator.maxTouchPoints > 0) document.body.classList.add("touch");
  const knob = stick.firstElementChild;
  const moves = { forward: 0, right: 0 };
  let last = null;
  const isTouch = (event) => event.pointerType !== "mouse";

  canvas.addEventListener("pointerdown", (event) => {
    if (!isTouch(event)) return;
    document.body.classList.add("touch");
    canvas.setPointerCapture(event.pointerId);
    last = event;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (last?.pointerId !== event.pointerId) return;
    // The picture follows the finger, so the gaze turns the other way.
    hideHint();
    look(-DRAG * (event.clientX - last.clientX), DRAG * (event.clientY - last.clientY));
    last = event;
  });
  const end = (event) => {
    if (last?.pointerId === event.pointerId) last = null;
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);

  const push = (event) => {
    hideHint();
    const box = stick.getBoundingClientRect();
    const reach = box.width / 2;
    const x = (event.clientX - box.left - reach) / reach;
    const y = (event.clientY - box.top - reach) / reach;
    const length = Math.max(1, Math.hypot(x, y));
    moves.right = x / length;
    moves.forward = -y / length;
    knob.style.transform = `translate(${(0.6 * reach * x) / length}px, ${(0.6 * reach * y) / length}px)`;
  };
  const release = () => {
    moves.right = 0;
    moves.forward = 0;
    knob.style.transform = "";
  };
  stick.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    stick.setPointerCapture(event.pointerId);
    push(event);
  });
  stick.addEventListener("pointermove", (event) => {
    if (stick.hasPointerCapture(event.pointerId)) push(event);
  });
  stick.addEventListener("pointerup", release);
  stick.addEventListener("pointercancel", release);
  return moves;
}
