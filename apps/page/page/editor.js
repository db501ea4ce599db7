// The editor of the scene's text: line numbers, and the error beside the line that causes it.

const $ = (id) => document.getElementById(id);

// Place of an error in the text: "name:line:column: message".
const PLACE = /:(\d+):(\d+): /;

let bad = 0;

// Shows the numbers of the lines, and marks the line with the error. Each number stands before an invisible copy of its line,
// which is wrapped like the text.
export function showLines() {
  const lines = $("text").value.split("\n").map((text, index) => {
    const line = document.createElement("div");
    const number = document.createElement("span");
    number.textContent = index + 1;
    number.className = index + 1 === bad ? "bad" : "";
    // An empty line is as high as another one.
    line.append(number, text || " ");
    return line;
  });
  $("lines").replaceChildren(...lines);
  $("lines").scrollTop = $("text").scrollTop;
}

// Shows an error above the text, with the line that causes it; "" removes the error.
export function showError(message) {
  const box = $("error");
  const place = message.match(PLACE);
  bad = place ? Number(place[1]) : 0;
  box.textContent = message;
  box.hidden = !message;
  $("text").setAttribute("aria-invalid", String(Boolean(message)));
  const line = $("text").value.split("\n")[bad - 1];
  if (place && line !== undefined) {
    const code = document.createElement("code");
    code.textContent = `line ${bad}: ${line.trim()}`;
    box.append(code);
  }
  if (message) {
    $("editor").open = true;
    // Text and error are visible together, or at least the error on a low screen.
    $("editor").scrollIntoView({ block: "nearest" });
    box.scrollIntoView({ block: "nearest" });
  }
  showLines();
}

// Shows warnings about the scene above its text. An empty list hides the box.
export function showWarnings(warnings) {
  const box = $("warnings");
  box.textContent = warnings.map((warning) => `Warning: ${warning}`).join("\n");
  box.hidden = warnings.length === 0;
}

// Keeps the numbers beside their lines while the text is scrolled.
export function listenToScrolling() {
  $("text").addEventListener("scroll", () => {
    $("lines").scrollTop = $("text").scrollTop;
  });
}
