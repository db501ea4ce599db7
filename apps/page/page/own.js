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

  // Returns the scene with this text, which is added with the wanted name if there is none.
  withText(wanted, text) {
    return this.all.find((own) => own.text === text) ?? this.add(wanted, text);
  }

  // Adds a scene. It gets the wanted name, unless that is empty or the name of another scene.
  add(wanted, text) {
    let name = wanted && !this.option(wanted) ? wanted : NAME;
    for (let number = 2; this.option(name); number++) name = `${NAME} ${number}`;
    const own = { name, text };
    this.all.push(own);
    this.list.add(new Option(name, name));
    this.keep();
    return own;
  }

  change(own, text) {
    own.text = text;
    this.keep();
  }

  // Gives a scene the wanted name, unless that is empty or the name of another scene.
  rename(own, wanted) {
    if (!wanted || this.option(wanted)) return;
    const option = this.option(own.name);
    own.name = option.value = option.text = wanted;
    this.keep();
  }

  remove(own) {
    this.all = this.all.filter((other) => other !== own);
    this.option(own.name)?.remove();
    this.keep();
  }

  option(name) {
    return Array.from(this.list.options).find((option) => option.value === name);
  }

  keep() {
    try {
      sessionStorage.setItem(KEY, JSON.stringify(this.all));
    } catch {
      // The texts stay until the page is closed.
    }
  }
}
