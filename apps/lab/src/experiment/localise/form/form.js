// The form shows one session at a time. Input for a trial is stored at once, under the key of the session. A locked
// answer is never replaced.
(() => {
  const { data, trials, newDraft, azimuth, isBeside, isObject, isAnswer, isSession, orderOf } = form;
  const prefix = `echomarch-localise:${data.experiment}:`;
  const byId = (id) => document.getElementById(id);
  const SVG = "http://www.w3.org/2000/svg";

  // { session, participant, started, order_seed, order: [number], answers: { number: answer },
  //   drafts: { number: draft }, saved: answers in the last file }
  let session = null;
  let place = 0; // position of the shown trial in the session's order
  let draft = null; // { spot, side, confidence, plays, seconds } of the shown trial, see newDraft
  let since = null; // performance.now() when the draft's seconds began to run
  let isKept = true; // whether this browser keeps stored answers
  let audio = null;

  // ---- storage --------------------------------------------------------------

  const warn = (text) => {
    byId("warning").textContent = text;
    byId("warning").hidden = text === "";
  };

  // Sessions from before order seeds were stored have an order that was computed from the session's name.
  const seedOf = ({ order_seed: seed }) => (seed === undefined ? null : seed);

  const read = (key) => {
    try {
      const stored = JSON.parse(localStorage.getItem(prefix + key));
      return isObject(stored) ? { ...stored, order_seed: seedOf(stored) } : null;
    } catch {
      return null;
    }
  };

  const keepsNothing = () => {
    isKept = false;
    warn("This browser cannot store answers: save a file before you close the page.");
  };

  // Stored answers take precedence, because an answer given in any tab is locked.
  const store = () => {
    const stored = read(session.session);
    if (isSession(stored)) {
      session.answers = { ...session.answers, ...stored.answers };
      session.drafts = { ...stored.drafts, ...session.drafts };
      session.saved = Math.max(session.saved, stored.saved);
    }
    for (const number of Object.keys(session.answers)) {
      delete session.drafts[number];
    }
    try {
      localStorage.setItem(prefix + session.session, JSON.stringify(session));
      isKept = true;
    } catch {
      keepsNothing();
    }
  };

  const storedSessions = () => {
    const found = [];
    try {
      for (let index = 0; index < localStorage.length; index += 1) {
        const key = localStorage.key(index);
        if (key.startsWith(prefix)) {
          found.push(read(key.slice(prefix.length)));
        }
      }
    } catch {
      keepsNothing();
    }
    return found.filter(isSession).sort((a, b) => (a.started < b.started ? 1 : -1));
  };

  const answered = (one) => Object.keys(one.answers).length;
  const isComplete = () => answered(session) === data.trials.length;
  const trialAt = (index) => trials.get(session.order[index]);
  const answerOf = (index) => session.answers[session.order[index]] || null;
  const firstOpen = () => session.order.findIndex((number) => !session.answers[number]);

  // ---- pages --------------------------------------------------------------------

  const show = (page) => {
    for (const id of ["start", "trial", "end"]) {
      byId(id).hidden = id !== page;
    }
    byId("footer").hidden = page === "start";
    const code = session && session.participant ? `${session.participant}, ` : "";
    byId("status").textContent = session
      ? `${code}${answered(session)} of ${data.trials.length} answered`
      : "";
  };

  const showStart = () => {
    byId("count").textContent = data.trials.length;
    const list = byId("sessions");
    list.replaceChildren();
    for (const one of storedSessions()) {
      const item = document.createElement("li");
      const button = document.createElement("button");
      button.type = "button";
      button.className = "continue";
      button.textContent = "Continue";
      button.addEventListener("click", () => enter(one));
      const code = one.participant || "no code";
      const text = ` ${code}, begun ${one.started.slice(0, 16).replace("T", " ")}: `
        + `${answered(one)} of ${data.trials.length} answered`;
      item.append(button, text);
      list.append(item);
    }
    show("start");
  };

  const enter = (one) => {
    session = one;
    draft = null;
    warn("");
    store();
    goOn();
  };

  const goOn = () => {
    const open = firstOpen();
    if (open < 0) {
      stopSound();
      show("end");
      byId("save").focus();
    } else {
      showTrial(open);
      byId("play").focus();
    }
  };

  const begin = () => {
    const [high, low, drawn] = crypto.getRandomValues(new Uint32Array(3));
    const name = [high, low].map((n) => n.toString(16).padStart(8, "0")).join("");
    const seed = data.orderSeed === null ? drawn : data.orderSeed;
    enter({
      session: name,
      participant: byId("participant").value.trim(),
      started: new Date().toISOString(),
      order_seed: seed,
      order: orderOf(seed),
      answers: {},
      drafts: {},
      saved: 0,
    });
  };

  // ---- one trial ----------------------------------------------------------------

  const seconds = () =>
    draft.seconds + (since === null ? 0 : (performance.now() - since) / 1000);

  // Stores the input for the shown trial unless the trial is locked. Also called before leaving the trial.
  const keep = () => {
    if (session && draft && !answerOf(place)) {
      session.drafts[session.order[place]] = { ...draft, seconds: seconds() };
      store();
    }
  };

  const takeUp = (index) => {
    const answer = answerOf(index);
    if (answer) {
      const { side, confidence } = answer;
      return { ...newDraft(), spot: answer, side, confidence };
    }
    return { ...newDraft(), ...session.drafts[session.order[index]] };
  };

  const showTrial = (index) => {
    keep();
    stopSound();
    place = index;
    const isLocked = answerOf(index) !== null;
    draft = takeUp(index);
    since = draft.plays > 0 ? performance.now() : null;
    const plan = data.plans[trialAt(index).plan];
    byId("number").textContent = `Sound ${index + 1} of ${data.trials.length}`;
    byId("view").src = plan.view;
    byId("bar").style.width = `${(100 * answered(session)) / data.trials.length}%`;
    for (const input of document.querySelectorAll("#trial fieldset input")) {
      input.checked = String(draft[input.name]) === input.value;
      input.disabled = isLocked;
    }
    byId("trial").classList.toggle("locked", isLocked);
    drawPlan(plan);
    update();
    show("trial");
  };

  const element = (name, attributes) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) {
      made.setAttribute(key, value);
    }
    return made;
  };

  // Coordinates in metres: x to the listener's right, y down the plan, which is against the gaze.
  const drawPlan = (plan) => {
    const svg = byId("plan");
    const [x, y] = [plan.min[0], -plan.max[1]];
    const [width, height] = [plan.max[0] - plan.min[0], plan.max[1] - plan.min[1]];
    svg.setAttribute("viewBox", `${x} ${y} ${width} ${height}`);
    const unit = width / 100;
    const blue = { stroke: "#0072b2", "stroke-width": 0.5 * unit };
    const tip = plan.radius + 4 * unit;
    const barb = `M ${-1.5 * unit} ${1.7 * unit - tip} L 0 ${-tip} L ${1.5 * unit} ${1.7 * unit - tip}`;
    svg.replaceChildren(
      element("image", { href: plan.plan, x, y, width, height }),
      element("circle", { r: plan.radius, fill: "#0072b229", ...blue }),
      element("path", { d: `M 0 0 V ${-tip} ${barb}`, fill: "none", ...blue }),
      element("g", { id: "mark" }),
    );
    drawMark(unit);
  };

  const drawMark = (unit) => {
    const mark = byId("mark");
    mark.replaceChildren();
    if (!draft.spot) {
      return;
    }
    const [x, y] = [draft.spot.right_m, -draft.spot.ahead_m];
    const line = { stroke: "#d55e00", "stroke-width": 0.5 * unit };
    mark.append(
      element("path", { d: `M 0 0 L ${x} ${y}`, "stroke-dasharray": unit, fill: "none", ...line }),
      element("circle", { cx: x, cy: y, r: 1.4 * unit, fill: "#d55e00", stroke: "#fff",
        "stroke-width": 0.4 * unit }),
    );
  };

  const placeMark = (right, ahead) => {
    if (answerOf(place)) {
      return;
    }
    const plan = data.plans[trialAt(place).plan];
    const held = (value, axis) => Math.min(Math.max(value, plan.min[axis]), plan.max[axis]);
    draft.spot = { right_m: held(right, 0), ahead_m: held(ahead, 1) };
    drawMark((plan.max[0] - plan.min[0]) / 100);
    update();
  };

  const clickPlan = (event) => {
    const svg = byId("plan");
    const point = new DOMPoint(event.clientX, event.clientY);
    const spot = point.matrixTransform(svg.getScreenCTM().inverse());
    placeMark(spot.x, -spot.y);
  };

  const pressOnPlan = (event) => {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    // With a modifier key, these keys belong to the browser (previous page, next word).
    if (!step || event.altKey || event.ctrlKey || event.metaKey) {
      return;
    }
    event.preventDefault();
    const from = draft.spot || { right_m: 0, ahead_m: 0 };
    placeMark(from.right_m + 0.5 * step[0], from.ahead_m + 0.5 * step[1]);
  };

  const stopSound = () => {
    if (audio) {
      audio.pause();
      audio = null;
    }
  };

  const play = async () => {
    stopSound();
    const index = place;
    audio = new Audio(trialAt(index).audio);
    try {
      await audio.play();
    } catch (error) {
      if (error.name !== "AbortError") {
        warn(`The sound cannot be played: ${error.message}`);
      }
      return;
    }
    if (index === place) {
      draft.plays += 1;
      since = since === null ? performance.now() : since;
      update();
    }
  };

  const chosen = (name) => {
    const input = document.querySelector(`input[name="${name}"]:checked`);
    return input ? input.value : null;
  };

  const choose = () => {
    draft.side = chosen("side");
    draft.confidence = chosen("confidence") && Number(chosen("confidence"));
    update();
  };

  const missing = () => {
    const { spot, side, confidence, plays } = draft;
    const all = [
      [plays === 0, "play the sound"],
      [!spot, "click on the plan"],
      [spot && !isBeside(spot), "put the mark beside yourself"],
      [!side, "choose a side"],
      [!confidence, "say how sure you are"],
    ];
    return all.filter(([is]) => is).map(([, what]) => what);
  };

  const where = (spot) => {
    if (!spot || !isBeside(spot)) {
      return "You are the circle; the arrow is your gaze.";
    }
    const side = spot.right_m < 0 ? "left" : "right";
    return `The mark is ${Math.abs(azimuth(spot)).toFixed(0)}° to the ${side} of your gaze.`;
  };

  // Updates a text only if it has changed, because screen readers read every update aloud.
  const say = (id, text) => {
    if (byId(id).textContent !== text) {
      byId(id).textContent = text;
    }
  };

  const update = () => {
    const locked = answerOf(place);
    const open = locked ? [] : missing();
    byId("lock").disabled = open.length > 0;
    byId("lock").textContent = locked ? "Continue" : "Lock the answer and continue";
    const still = open.length > 0 ? `Still to do: ${open.join(", ")}.` : "";
    say("missing", locked ? "This answer is locked." : still);
    const times = draft.plays === 1 ? "time" : "times";
    say("plays", draft.plays > 0 ? `played ${draft.plays} ${times}` : "");
    say("clicked", where(draft.spot));
    byId("back").disabled = place === 0;
    const first = firstOpen();
    byId("forward").disabled = place + 1 >= data.trials.length || (first >= 0 && place >= first);
    keep();
  };

  const lock = () => {
    if (!answerOf(place)) {
      const { right_m, ahead_m } = draft.spot;
      session.answers[session.order[place]] = {
        right_m,
        ahead_m,
        azimuth_deg: azimuth(draft.spot),
        side: draft.side,
        confidence: draft.confidence,
        plays: draft.plays,
        seconds: seconds(),
        answered: new Date().toISOString(),
      };
      store();
    }
    goOn();
  };

  // Asks for confirmation if closing the page would lose answers that exist only in this page, or a complete set of
  // answers that has not been saved.
  const warnOfLoss = (event) => {
    if (session && answered(session) > session.saved && (!isKept || isComplete())) {
      event.preventDefault();
    }
  };

  // ---- files --------------------------------------------------------------------

  const save = () => {
    const now = new Date().toISOString();
    const file = {
      format: data.format,
      version: data.version,
      experiment: data.experiment,
      session: session.session,
      participant: session.participant,
      started: session.started,
      saved: now,
      order_seed: session.order_seed,
      order: session.order,
      trials: data.trials.map(({ number, stimulus }) => ({
        number,
        stimulus,
        answer: session.answers[number] || null,
      })),
    };
    const text = `${JSON.stringify(file, null, 1)}\n`;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
    link.download = `answers-${session.session}-${now.replace(/[-:]/g, "").replace(/[T.]/g, "-")}.json`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    session.saved = answered(session);
    store();
    byId("saved").textContent = `Saved as ${link.download} among your downloads.`;
  };

  // Returns the session in a file, if its trials and answers have the format of saved files.
  const sessionOf = (file) => {
    const { session: name, participant, started, order } = file;
    const answers = {};
    const isTrial = (trial, index) => isObject(trial) && trial.number === index + 1;
    if (!Array.isArray(file.trials) || file.trials.length !== trials.size
      || !file.trials.every(isTrial)) {
      throw new Error("its trials are not those of this form");
    }
    for (const { number, answer } of file.trials.filter((trial) => trial.answer)) {
      if (!isAnswer(answer)) {
        throw new Error(`the answer to trial ${number} is damaged`);
      }
      answers[number] = answer;
    }
    const saved = Object.keys(answers).length;
    const found = { session: name, participant, started, order_seed: seedOf(file), order, answers,
      drafts: {}, saved };
    if (!isSession(found)) {
      throw new Error("the session, its person, its beginning or its order is damaged");
    }
    return found;
  };

  const load = async () => {
    const [chosenFile] = byId("load").files;
    if (!chosenFile) {
      return;
    }
    try {
      const file = JSON.parse(await chosenFile.text());
      if (!isObject(file) || file.format !== data.format || file.version !== data.version) {
        throw new Error("it contains no answers of this kind of form");
      }
      if (file.experiment !== data.experiment) {
        throw new Error("it belongs to another form");
      }
      enter(sessionOf(file));
    } catch (error) {
      warn(`${chosenFile.name} cannot be loaded: ${error.message}`);
    }
    byId("load").value = "";
  };

  // ---- a tone on one side, to check the headphones ---------------------------------

  const tone = (channel) => {
    const context = new AudioContext();
    const rate = context.sampleRate;
    const buffer = context.createBuffer(2, rate / 2, rate);
    const samples = buffer.getChannelData(channel);
    for (let index = 0; index < samples.length; index += 1) {
      const fade = Math.min(1, index / 500, (samples.length - index) / 500);
      samples[index] = 0.3 * fade * Math.sin((2 * Math.PI * 500 * index) / rate);
    }
    const source = context.createBufferSource();
    source.buffer = buffer;
    source.connect(context.destination);
    source.addEventListener("ended", () => context.close());
    source.start();
  };

  // ---- wiring -------------------------------------------------------------------

  for (let value = 1; value <= data.mostConfident; value += 1) {
    const label = document.createElement("label");
    const input = document.createElement("input");
    Object.assign(input, { type: "radio", name: "confidence", value: String(value) });
    label.append(input, ` ${value}`);
    byId("confidences").append(label);
  }
  const on = (id, event, action) => byId(id).addEventListener(event, action);
  on("begin", "click", begin);
  on("load", "change", load);
  on("check-left", "click", () => tone(0));
  on("check-right", "click", () => tone(1));
  on("play", "click", play);
  on("plan", "click", clickPlan);
  on("plan", "keydown", pressOnPlan);
  on("trial", "change", choose);
  on("lock", "click", lock);
  on("back", "click", () => showTrial(place - 1));
  on("forward", "click", () => showTrial(place + 1));
  on("review", "click", () => showTrial(0));
  on("save", "click", save);
  addEventListener("pagehide", keep);
  addEventListener("beforeunload", warnOfLoss);
  showStart();
})();
