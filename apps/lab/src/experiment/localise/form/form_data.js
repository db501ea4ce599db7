"use strict";
// The data of a form, and the validity checks of answers, drafts and sessions. The program that reads the answers makes
// the same checks.
const form = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const trials = new Map(data.trials.map((trial) => [trial.number, trial]));
  // Input for a trial that is not locked. `seconds` counts from the first playback, only while the trial is shown.
  const newDraft = () => ({ spot: null, side: null, confidence: null, plays: 0, seconds: 0 });

  const isText = (value) => typeof value === "string";
  const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);
  const isSide = (value) => ["left", "centre", "right"].includes(value);
  const isConfidence = (value) =>
    Number.isInteger(value) && value >= 1 && value <= data.mostConfident;
  const isSpot = (value) =>
    isObject(value) && Number.isFinite(value.right_m) && Number.isFinite(value.ahead_m);
  const isOrder = (value) => Array.isArray(value) && value.length === trials.size
    && new Set(value).size === trials.size && value.every((number) => trials.has(number));

  // A click at the listener has no direction.
  const isBeside = (spot) => Math.hypot(spot.right_m, spot.ahead_m) > 0.001;
  const azimuth = (spot) => (Math.atan2(spot.right_m, spot.ahead_m) * 180) / Math.PI;

  const isAnswer = (value) => {
    if (!isSpot(value) || !isBeside(value) || !Number.isFinite(value.azimuth_deg)) {
      return false;
    }
    const off = Math.abs(azimuth(value) - value.azimuth_deg) % 360;
    return Math.min(off, 360 - off) <= 1 && Math.abs(value.azimuth_deg) <= 180
      && isSide(value.side) && isConfidence(value.confidence)
      && Number.isInteger(value.plays) && value.plays >= 1
      && Number.isFinite(value.seconds) && value.seconds >= 0 && isText(value.answered);
  };

  const isDraft = (value) => isObject(value)
    && (value.spot === null || isSpot(value.spot))
    && (value.side === null || isSide(value.side))
    && (value.confidence === null || isConfidence(value.confidence))
    && Number.isInteger(value.plays) && value.plays >= 0
    && Number.isFinite(value.seconds) && value.seconds >= 0;

  const areOf = (value, isOne) => isObject(value)
    && Object.entries(value).every(([number, one]) => trials.has(Number(number)) && isOne(one));

  const isSession = (value) => isObject(value) && isText(value.session) && value.session !== ""
    && isText(value.participant) && isText(value.started) && isOrder(value.order)
    && (value.order_seed === null || isOrderOf(value.order, value.order_seed))
    && areOf(value.answers, isAnswer) && areOf(value.drafts, isDraft)
    && Number.isInteger(value.saved);

  // The order of a session: the trials sorted by a hash of trial, form and order seed (FNV-1a with the final mixing
  // step of MurmurHash3).
  const rank = (text) => {
    let hash = 0x811c9dc5;
    for (const letter of text) {
      hash = Math.imul(hash ^ letter.codePointAt(0), 0x01000193);
    }
    hash = Math.imul(hash ^ (hash >>> 16), 0x85ebca6b);
    hash = Math.imul(hash ^ (hash >>> 13), 0xc2b2ae35);
    return (hash ^ (hash >>> 16)) >>> 0;
  };

  const orderOf = (seed) => {
    const ranked = [...trials.keys()].map((number) =>
      ({ number, rank: rank(`${number}:${data.seed}:${seed}`) }));
    ranked.sort((a, b) => a.rank - b.rank || a.number - b.number);
    return ranked.map(({ number }) => number);
  };

  const isOrderOf = (order, seed) => Number.isInteger(seed) && seed >= 0 && seed <= 0xffffffff
    && orderOf(seed).every((number, index) => number === order[index]);

  return { data, trials, newDraft, azimuth, isBeside, isObject, isAnswer, isSession, orderOf };
})();
