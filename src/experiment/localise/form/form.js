"use strict";
// The form: one session at a time. An answer is stored the moment it is locked, under a key
// of its own session, and what is stored is never replaced.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const prefix = `echomarch-localise:${data.experiment}:`;
  const byId = (id) => document.getElementById(id);
  const SVG = "http://www.w3.org/2000/svg";

  let session = null; // { session, participant, started, answers: { number: answer } }
  let place = 0; // index of the trial shown
  let draft = null; // { right_m, ahead_m } clicked, not locked
  let plays = 0;
  let firstPlayed = null;
  let audio = null;

  // ---- what is kept -------------------------------------------------------------

  const warn = (text) => {
    byId("warning").textContent = text;
    byId("warning").hidden = text === "";
  };

  const read = (key) => {
    try {
      return JSON.parse(localStorage.getItem(prefix + key));
    } catch {
      return null;
    }
  };

  // What is stored wins: answers are locked, in whichever tab they were given.
  const store = () => {
    const stored = read(session.session);
    if (stored) {
      session.answers = { ...session.answers, ...stored.answers };
    }
    try {
      localStorage.setItem(prefix + session.session, JSON.stringify(session));
    } catch {
      warn("This browser keeps nothing: save a file before you close the page.");
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
      warn("This browser keeps nothing: save a file before you close the page.");
    }
    const usable = found.filter((one) => one && one.session && one.answers);
    return usable.sort((a, b) => (a.started < b.started ? 1 : -1));
  };

  const answered = (one) => Object.keys(one.answers).length;
  const answerOf = (index) => session.answers[data.trials[index].number] || null;
  const firstOpen = () => data.trials.findIndex((trial) => !session.answers[trial.number]);

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
      button.textContent = "Go on";
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
    warn("");
    store();
    goOn();
  };

  const goOn = () => {
    const open = firstOpen();
    if (open < 0) {
      stopSound();
      show("end");
    } else {
      showTrial(open);
    }
  };

  const begin = () => {
    const number = crypto.getRandomValues(new Uint32Array(2));
    const name = Array.from(number, (n) => n.toString(16).padStart(8, "0")).join("");
    enter({
      session: name,
      participant: byId("participant").value.trim(),
      started: new Date().toISOString(),
      answers: {},
    });
  };

  // ---- one trial ----------------------------------------------------------------

  const showTrial = (index) => {
    stopSound();
    place = index;
    const answer = answerOf(index);
    draft = answer;
    plays = 0;
    firstPlayed = null;
    const plan = data.plans[data.trials[index].plan];
    byId("number").textContent = `Sound ${index + 1} of ${data.trials.length}`;
    byId("view").src = plan.view;
    byId("bar").style.width = `${(100 * answered(session)) / data.trials.length}%`;
    for (const input of document.querySelectorAll("#trial fieldset input")) {
      input.checked = answer !== null && String(answer[input.name]) === input.value;
      input.disabled = answer !== null;
    }
    byId("trial").classList.toggle("locked", answer !== null);
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

  // Metres: x to the listener's right, and y down, which is away from its gaze.
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
    if (!draft) {
      return;
    }
    const [x, y] = [draft.right_m, -draft.ahead_m];
    const line = { stroke: "#d55e00", "stroke-width": 0.5 * unit };
    mark.append(
      element("path", { d: `M 0 0 L ${x} ${y}`, "stroke-dasharray": unit, fill: "none", ...line }),
      element("circle", { cx: x, cy: y, r: 1.4 * unit, fill: "#d55e00", stroke: "#fff",
        "stroke-width": 0.4 * unit }),
    );
  };

  const azimuth = (spot) => (Math.atan2(spot.right_m, spot.ahead_m) * 180) / Math.PI;

  const placeMark = (right, ahead) => {
    if (answerOf(place)) {
      return;
    }
    const plan = data.plans[data.trials[place].plan];
    const held = (value, axis) => Math.min(Math.max(value, plan.min[axis]), plan.max[axis]);
    draft = { right_m: held(right, 0), ahead_m: held(ahead, 1) };
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
    if (!step) {
      return;
    }
    event.preventDefault();
    const from = draft || { right_m: 0, ahead_m: 0 };
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
    audio = new Audio(data.trials[index].audio);
    try {
      await audio.play();
    } catch (error) {
      if (error.name !== "AbortError") {
        warn(`The sound cannot be played: ${error.message}`);
      }
      return;
    }
    if (index === place) {
      plays += 1;
      firstPlayed = firstPlayed || Date.now();
      update();
    }
  };

  const chosen = (name) => {
    const input = document.querySelector(`input[name="${name}"]:checked`);
    return input ? input.value : null;
  };

  const update = () => {
    const locked = answerOf(place);
    const missing = [];
    if (!locked) {
      if (plays === 0) missing.push("play the sound");
      if (!draft) missing.push("click on the plan");
      if (!chosen("side")) missing.push("choose a side");
      if (!chosen("confidence")) missing.push("say how sure you are");
    }
    byId("lock").disabled = !locked && missing.length > 0;
    byId("lock").textContent = locked ? "Go on" : "Lock the answer and go on";
    byId("missing").textContent = locked
      ? "This answer is locked."
      : missing.length > 0 ? `Still to do: ${missing.join(", ")}.` : "";
    byId("plays").textContent = plays > 0 ? `played ${plays} times`.replace(/^(played 1) times/, "$1 time") : "";
    byId("clicked").textContent = draft
      ? `The mark is ${Math.abs(azimuth(draft)).toFixed(0)}° to the ${draft.right_m < 0 ? "left" : "right"} of your gaze.`
      : "You are the circle; the arrow is your gaze.";
    byId("back").disabled = place === 0;
    const open = firstOpen();
    byId("forward").disabled = place + 1 >= data.trials.length || (open >= 0 && place >= open);
  };

  const lock = () => {
    if (!answerOf(place)) {
      const now = new Date();
      session.answers[data.trials[place].number] = {
        right_m: draft.right_m,
        ahead_m: draft.ahead_m,
        azimuth_deg: azimuth(draft),
        side: chosen("side"),
        confidence: Number(chosen("confidence")),
        plays,
        seconds: (now.getTime() - firstPlayed) / 1000,
        answered: now.toISOString(),
      };
      store();
    }
    goOn();
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
    byId("saved").textContent = `Saved as ${link.download} among your downloads.`;
  };

  const load = async () => {
    const [chosenFile] = byId("load").files;
    if (!chosenFile) {
      return;
    }
    try {
      const file = JSON.parse(await chosenFile.text());
      if (file.format !== data.format || file.version !== data.version) {
        throw new Error("it holds no answers of this kind of form");
      }
      if (file.experiment !== data.experiment) {
        throw new Error("it belongs to another form");
      }
      const answers = {};
      for (const trial of file.trials) {
        if (trial.answer) {
          answers[trial.number] = trial.answer;
        }
      }
      const { session: name, participant, started } = file;
      enter({ session: name, participant, started, answers });
    } catch (error) {
      warn(`${chosenFile.name} cannot be taken up: ${error.message}`);
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
  on("trial", "change", update);
  on("lock", "click", lock);
  on("back", "click", () => showTrial(place - 1));
  on("forward", "click", () => showTrial(place + 1));
  on("review", "click", () => showTrial(0));
  on("save", "click", save);
  showStart();
})();
