// What is told over the picture: a line for each part of the page that has something to say.

export class Messages {
  constructor(element) {
    this.element = element;
    this.lines = new Map();
  }

  // What a part of the page says; "" takes back what it has said.
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
