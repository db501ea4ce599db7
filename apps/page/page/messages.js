// The messages over the picture: at most one line for each part of the page.

export class Messages {
  constructor(element) {
    this.element = element;
    this.lines = new Map();
  }

  // Sets the message of a part of the page; "" removes it.
  say(part, text) {
    if ((this.lines.get(part) ?? "") === text) return;
    if (text) {
      this.lines.set(part, text);
    } else {
      this.lines.delete(part);
    }
    this.element.textContent = Array.from(this.lines.values()).join("\n");
    this.element.hidden = this.lines.size === 0;
  }
}
