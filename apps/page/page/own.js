// The scenes whose text the user has written. The list of scenes keeps them after another scene was chosen, and after
// the page was loaded again, until the browser's tab is closed.

const KEY = "echomarch.own";
const NAME = "your scene";

// Returns the texts that were kept in this tab. A browser may forbid a page to keep anything.
function kept() {
  try {
    return JSON.parse(sessionStorage.getItem(KEY)) ?? [];
  } catch {
    return [];
  }
}

export class OwnScenes {
  // Shows the kept scenes at the end of the list.
  constructor(list) {
    this.list = list;
    this.all = kept();
    this.all.forEach(({ name }) => list.add(new Option(name, name)));
  }

  // Returns the scene with this name; null for the name of a built-in scene.
  named(name) {
    return this.all.find((own) => own.name === name) ?? null;
  }

  // Returns the scene with this text, which is added if there is none. It was made from the built-in scene `scene`.
  withText(scene, text) {
    return this.all.find((own) => own.scene === scene && own.text === text) ?? this.add(scene, text);
  }

  add(scene, text) {
    let name = NAME;
    for (let number = 2; this.named(name); number++) name = `${NAME} ${number}`;
    const own = { name, scene, text };
    this.all.push(own);
    this.list.add(new Option(name, name));
    this.keep();
    return own;
  }

  change(own, text) {
    own.text = text;
    this.keep();
  }

  remove(own) {
    this.all = this.all.filter((other) => other !== own);
    Array.from(this.list.options).find((option) => option.value === own.name)?.remove();
    this.keep();
  }

  keep() {
    try {
      sessionStorage.setItem(KEY, JSON.stringify(this.all));
    } catch {
      // The texts stay until the page is closed.
    }
  }
}
