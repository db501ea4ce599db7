// The messages over the picture: a line for each part of the page that has one.

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
