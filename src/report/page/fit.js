// SPDX-License-Identifier: GPL-3.0-or-later
// What a fitted model forecasts: bands beside the run's motion, its time of failure, its estimates.
"use strict";

// Quantiles of the posterior as the data hold them.
const Q05 = 0, Q25 = 1, Q50 = 2, Q75 = 3, Q95 = 4;

// A fit's displacements on the run's slip: moved as the readings are.
function onSlip(data, list) {
  const offset = data.series?.point === data.fit.point ? data.series?.offset ?? 0 : 0;
  return list.map((v) => (v === null ? null : v - offset));
}

function bandLines(fit, of, words) {
  const common = { time: fit.time, colour: "fit", follows: true, ahead: true, kind: "area" };
  const band = (name, low, high, inner) => ({ ...common, name, inner, y: of[Q50], low: of[low], high: of[high] });
  return [band("fitted model, 90 %", Q05, Q95, false), band("50 %", Q25, Q75, true),
    { ...common, name: "its median", kind: "line", dash: true, y: of[Q50], words: (i) => `fitted model ${words(of[Q05][i])} to ${words(of[Q95][i])} (90 %)` }];
}

// The fit of readings of a point, or of the whole.
const fitOf = (data, point) => (data.fit && data.fit.point === point ? data.fit : null);

function fitSlip(data, point) {
  const fit = fitOf(data, point);
  if (!fit || !fit.time.length) return [];
  if (fit.slip.length) return bandLines(fit, fit.slip.map((list) => onSlip(data, list)), (v) => (v === null ? "failure" : length(v, 3)));
  const y = onSlip(data, fit.best);
  return [{ name: "best fit", kind: "line", dash: true, colour: "fit", time: fit.time, follows: true, ahead: true, y, words: (i) => `best fit ${length(y[i], 3)}` }];
}

function fitRates(data, point) {
  const fit = fitOf(data, point);
  return fit?.rate.length ? bandLines(fit, fit.rate, (v) => (v === null ? "failure" : rate(v))) : [];
}

// What the creep curve's axis must hold of a fit: its middle as far as readings go, and a little more.
function fitCore(data, point) {
  const lines = fitSlip(data, point);
  if (!lines.length) return [];
  const { time, y } = lines[lines.length - 1], fit = data.fit;
  const far = fit.until + 0.1 * (fit.until - fit.from);
  return [y.filter((_, i) => time[i] <= far)];
}

// How far the time axis goes for its time of failure: to the end of the 90 %, or half as far again as the run.
function fitReach(data) {
  const at = data.fit?.failure?.quantile.filter((t) => t !== null) ?? [], m = data.motion, last = m.time[m.time.length - 1];
  return at.length ? [Math.min(at[at.length - 1], m.time[0] + 1.5 * (Math.max(last, data.fit.until) - m.time[0]))] : [];
}

function fitSpans(data) {
  const at = data.fit?.failure?.quantile;
  return at?.length && at[Q05] !== null ? [{ at, label: "failure, fitted model" }] : [];
}

const fitWords = (fit) => (fit.slip.length
  ? `Shaded: what the model of ${fit.name}, fitted to the readings up to ${moment(page.clock, fit.until)} and to nothing later, says of the slip; without the scatter of the readings.`
  : `Dashed: the best fit of ${fit.name} to the readings up to ${moment(page.clock, fit.until)}.`);

function failureChart(fit) {
  const f = fit.failure, time = f.time, marks = [0.05, 0.5, 0.95].map((y) => ({ y, label: `${number(100 * y)} %` }));
  if (page.clock.failure !== null) marks.push({ x: page.clock.failure, label: "failure of the run" });
  return figure({
    title: "Time of failure of the fitted model", x: { clock: true, axis: "time", range: [Math.min(fit.until, time[0]), time[time.length - 1]] }, marks,
    y: { kind: "linear", fixed: true, label: "Share of the draws that have failed", tick: plain(3), range: [0, 1.02] },
    lines: [{ kind: "step", colour: "fit", time, y: f.share }],
    caption: `Each of ${count(f.draws)} draws of the posterior was run on. The axis begins at the last reading used.`,
    readout: (i) => `${moment(page.clock, time[i])}: ${number(100 * f.share[i], 3)} % have failed`,
    table: { n: time.length, caption: "time of failure of the fitted model", columns: [["Time", (i) => moment(page.clock, time[i])],
      ["Share failed", (i) => `${number(100 * f.share[i], 3)} %`]] },
  });
}

function estimateTable(fit) {
  const e = fit.estimates, sampled = e.some((one) => one.median !== undefined);
  const words = (one, v) => quantity(v, one.unit);
  const error = (one) => (one.log_error !== null ? `a factor of ${number(Math.exp(one.log_error), 3)}` : words(one, one.error));
  const columns = [["Estimate", (i) => e[i].key], ["Best fit", (i) => `${words(e[i], e[i].best)}${e[i].limit !== null ? `, at the end of its range, ${words(e[i], e[i].limit)}` : ""}`]];
  if (sampled) columns.push(["Median", (i) => words(e[i], e[i].median)], ["90 %", (i) => `${words(e[i], e[i].low90)} to ${words(e[i], e[i].high90)}`], ["R-hat", (i) => number(e[i].rhat)]);
  else columns.push(["Standard error", (i) => error(e[i])]);
  return element("div", { class: "plain" }, bareTable(sampled ? "What was fitted, and its posterior" : "What was fitted", e.length, columns));
}

function failureWords(fit) {
  const f = fit.failure;
  if (!f) return "It was not sampled, so that it says nothing of a time of failure.";
  if (f.failing === 0) return `None of ${count(f.draws)} draws fails by the end of the model's time.`;
  const when = (t) => (t === null ? "never" : moment(page.clock, t)), q = f.quantile;
  const some = f.failing < f.draws ? ` ${number((100 * f.failing) / f.draws, 3)} % of its draws fail at all by the end of the model's time.` : "";
  return `Failure: median ${when(q[Q50])}; 50 % ${when(q[Q25])} to ${when(q[Q75])}; 90 % ${when(q[Q05])} to ${when(q[Q95])}.${some}`;
}

function fitSection(data) {
  const fit = data.fit;
  const section = openSection("fit", "Fitted model", `${fit.title ? `${fit.title}: ` : ""}${many(fit.readings, "reading")} from ${moment(page.clock, fit.from)} to ${moment(page.clock, fit.until)}, and none later. ${failureWords(fit)}`);
  if (fit.failure?.failing > 1) section.append(failureChart(fit));
  if (fit.estimates.length) section.append(estimateTable(fit));
  return section;
}
