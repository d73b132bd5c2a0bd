// SPDX-License-Identifier: GPL-3.0-or-later
// Slip from scale to scale, its map and fixed points; correlation length; the catalogue of events.
"use strict";

const LEVEL_RAMP = ["#3b528b", "#2c718e", "#21908d", "#27ad81", "#5cc863", "#a0c93a", "#d9b92b", "#e08a2a", "#c8541f"];
const levelColour = (k, n) => LEVEL_RAMP[Math.round((k / Math.max(1, n - 1)) * (LEVEL_RAMP.length - 1))];

const part = (levels, level, i) => levels.slipping[level][i] / levels.total[level];

function levelChart(levels) {
  const shown = levels.size.map((_, k) => k).filter((k) => levels.slipping[k].some((n) => n > 0));
  const marks = levels.critical_fraction !== null ? [{ y: levels.critical_fraction, label: `fixed point ${number(levels.critical_fraction, 3)}` }] : [];
  return figure({
    title: "Slipping part of the blocks of each size", caption: `A block slips where all its contact cells do: ${levels.definition}.`,
    x: { clock: true, before: lastDecades(levels) }, y: { kind: "linear", label: "N slipping / N", tick: plain(3), range: [0, 1.02] }, marks,
    lines: shown.map((k, j) => ({ name: `blocks of ${length(levels.size[k], 3)}`, kind: "step", colour: "run", stroke: levelColour(j, shown.length),
      time: levels.time, before: levels.before, y: levels.slipping[k].map((_, i) => part(levels, k, i)) })),
    readout: (i) => `${moment(page.clock, levels.time[i])}, ${beforeEnd(page.clock, levels.before[i])}: ` +
      shown.map((k) => `${length(levels.size[k], 2)} ${number(part(levels, k, i), 2)}`).join(", "),
    table: { n: levels.time.length, caption: "slipping part of the blocks of each size", columns: [...clockColumns(levels),
      ...levels.size.map((s, k) => [length(s, 3), (i) => number(part(levels, k, i), 3)]), ["Longest cluster", (i) => length(levels.length[i])]] },
  });
}

// From a little before anything slips.
function lastDecades(levels) {
  const first = levels.fraction.findIndex((v) => v > 0);
  const [low, high] = extentPositive([levels.before]);
  return first < 0 ? [low, high] : [low, Math.min(high, 3 * Math.max(levels.before[first], low))];
}

function lengthChart(levels, data) {
  const whole = Math.max(data.about.grid_nx * data.about.grid_dx_m, data.about.grid_ny * data.about.grid_dy_m);
  const y = levels.length.map((v) => (v > 0 ? v : null));
  return figure({
    title: "Correlation length", caption: "Longest side of a connected cluster of slipping cells. It is not drawn where none slips.",
    x: { clock: true, before: lastDecades(levels) }, marks: [{ y: whole, label: "the interface" }],
    y: { kind: "log", label: "Length (m)", tick: (v) => length(v, 2), range: [extentPositive([levels.length])[0] / 1.3, whole * 1.5] },
    lines: [{ kind: "step", colour: "run", time: levels.time, before: levels.before, y }],
    readout: (i) => `${moment(page.clock, levels.time[i])}, ${beforeEnd(page.clock, levels.before[i])}: ${y[i] === null ? "none slips" : length(y[i])}`,
    table: { n: levels.time.length, caption: "correlation length", columns: [...clockColumns(levels), ["Length", (i) => length(levels.length[i])],
      ["Slipping part of the cells", (i) => number(levels.fraction[i], 3)]] },
  });
}

// S(s) of a map with this slope at this fixed point: logit S = lambda (logit s - logit C) + logit C.
function mapCurve(lambda, fixed) {
  const logit = (s) => Math.log(s / (1 - s)), x = [], y = [];
  for (let k = 1; k < 200; k++) {
    x.push(k / 200);
    y.push(1 / (1 + Math.exp(-(lambda * (logit(k / 200) - logit(fixed)) + logit(fixed)))));
  }
  return { x, y };
}

// Pairs (s of a level, s of the next) of the records at which something slips.
function trajectory(levels) {
  const lines = [], n = levels.size.length;
  for (let k = 0; k + 1 < n && levels.total[k + 1] >= 8; k++) {
    const keep = levels.time.map((_, i) => i).filter((i) => part(levels, k, i) > 0);
    lines.push({ level: k, index: keep, x: keep.map((i) => part(levels, k, i)), y: keep.map((i) => part(levels, k + 1, i)) });
  }
  return lines.filter((line) => line.x.length > 0);
}

function staircase(levels, i) {
  const x = [], y = [];
  for (let k = 0; k + 1 < levels.size.length && levels.total[k + 1] >= 8; k++) {
    const s = part(levels, k, i), next = part(levels, k + 1, i);
    x.push(s, s, next);
    y.push(k === 0 ? 0 : s, next, next);
  }
  return { x, y };
}

function fixedDots(levels) {
  const dots = [];
  if (levels.critical_fraction !== null) dots.push({ name: "fixed point of the static cascade", at: levels.critical_fraction, colour: "fast" });
  if (levels.run_critical_fraction !== null) dots.push({ name: "fixed point of the run's own map", at: levels.run_critical_fraction, colour: "seen" });
  return dots.map((d) => ({ name: d.name, kind: "dots", colour: d.colour, x: [d.at], y: [d.at], radius: [6], low: [d.at], high: [d.at] }));
}

function rgChart(levels) {
  const paths = trajectory(levels);
  if (!paths.length) return null;
  const lines = paths.map((p, j) => ({ name: `${length(levels.size[p.level], 2)} to ${length(levels.size[p.level + 1], 2)}`, kind: "line", thin: true,
    colour: "run", stroke: levelColour(j, paths.length), x: p.x, y: p.y }));
  lines.push({ name: "no change of scale", kind: "line", dash: true, thin: true, colour: "quiet", x: [0, 1], y: [0, 1] });
  if (levels.run_lambda !== null && levels.run_critical_fraction !== null) {
    lines.push({ name: `map fitted to the run, λ ${number(levels.run_lambda, 3)}`, kind: "line", colour: "seen", ...mapCurve(levels.run_lambda, levels.run_critical_fraction) });
  }
  lines.push(...fixedDots(levels), { name: "at the chosen time", kind: "line", colour: "fast", x: [], y: [] });
  return figure({
    title: "Renormalization map", height: 420, x: { label: "slipping part s of the blocks of one size", kind: "linear", tick: plain(3), range: [0, 1] },
    y: { kind: "linear", label: "s′ of blocks twice the size", tick: plain(3), range: [0, 1] }, lines,
    caption: "The part s of the blocks of one size that slips, and s′ of the blocks twice as large: the run's trajectory, a line for each pair of sizes.",
    readout: (i) => `${moment(page.clock, levels.time[paths[0].index[i]])}, ${beforeEnd(page.clock, levels.before[paths[0].index[i]])}: s ${number(paths[0].x[i], 3)}, s′ ${number(paths[0].y[i], 3)}`,
    table: { n: paths[0].index.length, caption: "slipping part from one size to the next", columns: [
      ["Time", (r) => moment(page.clock, levels.time[paths[0].index[r]])], [`Before ${page.clock.end}`, (r) => span(levels.before[paths[0].index[r]])],
      ...levels.size.map((s, k) => [length(s, 3), (r) => number(part(levels, k, paths[0].index[r]), 3)])] },
  });
}

function rgSlider(levels, chart) {
  const moving = levels.time.map((_, i) => i).filter((i) => levels.fraction[i] > 0);
  const line = chart.spec.lines[chart.spec.lines.length - 1];
  const set = (k) => {
    Object.assign(line, staircase(levels, moving[k]));
    if (chart.plot) chart.draw();
  };
  const at = Math.floor(moving.length * 0.8);
  set(at);
  return slider({ name: "Time", id: "level-time", n: moving.length, at, times: moving.map((i) => levels.time[i]), change: set,
    words: (k) => `${moment(page.clock, levels.time[moving[k]])}, ${beforeEnd(page.clock, levels.before[moving[k]])}: ${number(100 * levels.fraction[moving[k]], 3)} % of the cells slip` });
}

function rgWords(levels) {
  return element("p", {}, "Read the map as the cascade is read: from the part of the cells that slips, up to the curve, across to the dashed line, up again, one step for each doubling of the block. " +
    "Above the dashed line slip spreads to larger blocks, below it dies out on the way; where a map crosses it stands its fixed point. " +
    `The static fixed point is of the run's own contact domain (${levels.source}); the run's own map is fitted to what slipped on the way.`);
}

function fixedPoints(levels) {
  const between = (key) => (levels[`${key}_low`] === null ? "–" : `${number(levels[`${key}_low`], 3)} to ${number(levels[`${key}_high`], 3)}`);
  const rows = [["Fixed point of the static cascade", "critical_fraction"], ["Fixed point of the run's own map", "run_critical_fraction"], ["Slope λ of the run's own map", "run_lambda"]]
    .filter(([, key]) => levels[key] !== null);
  if (levels.criticality && levels.criticality.some((v) => v !== null)) rows.push(["Slipping part over the static fixed point, at most", null]);
  return element("div", { class: "plain" }, bareTable("Fixed points", rows.length, [["", (i) => rows[i][0]],
    ["Value", (i) => number(rows[i][1] === null ? extent([levels.criticality])[1] : levels[rows[i][1]], 3)], ["95 %", (i) => (rows[i][1] === null ? "–" : between(rows[i][1]))]]));
}

function levelsSection(data) {
  const levels = data.levels;
  const section = openSection("scales", "From scale to scale", "Which part of the blocks of each size slips, and how that part changes from one size to the next: the renormalization of the static cascade, read off a run in time.");
  if (!levels.fraction.some((v) => v > 0) || !levels.slipping[0].some((n) => n > 0)) {
    section.append(element("p", { class: "note" }, "No cell slips in this run by the definition used."));
    return section;
  }
  section.append(element("div", { class: "pair" }, levelChart(levels), lengthChart(levels, data)));
  const map = rgChart(levels);
  if (map) {
    section.append(element("div", { class: "pair" }, map,
      element("div", { class: "aside" }, rgSlider(levels, map.chart), rgWords(levels), fixedPoints(levels))));
  }
  return section;
}

function eventTime(events) {
  const largest = Math.max(...events.size, 1e-300);
  const radius = events.size.map((v) => 2 + 9 * Math.sqrt(Math.max(0, v / largest)));
  const moments = events.moment.some((v) => v !== null);
  const key = moments ? "moment" : "potency", unit = moments ? "N m" : "m³";
  const before = events.time.map((t) => Math.max(0, page.clock.last - t));
  return figure({
    title: "Events in time", caption: "Each circle an event; its area grows with the length of its patch.",
    x: { clock: true }, y: { kind: "log", label: `${moments ? "Moment" : "Potency"} (${unit})`, tick: powerTick, clear: 0.06 },
    lines: [{ kind: "dots", full: true, colour: "run", time: events.time, before, y: events[key], radius }],
    readout: (i) => `${moment(page.clock, events.time[i])}: ${key} ${number(events[key][i], 3)} ${unit}, ${length(events.size[i])} long, ${many(events.cells[i], "cell")}, ${span(events.duration[i])}`,
    table: { n: events.time.length, caption: "events", columns: [["Start", (i) => moment(page.clock, events.time[i])], ["Duration", (i) => span(events.duration[i])],
      ["Cells", (i) => count(events.cells[i])], ["Length", (i) => length(events.size[i])], ["Potency (m³)", (i) => number(events.potency[i], 3)],
      ["Moment (N m)", (i) => number(events.moment[i], 3)], ["Largest rate", (i) => rate(events.max_rate[i])]] },
  });
}

function eventSizes(events) {
  const b = events.b_value;
  const words = b.reason ? `No b-value: ${b.reason}.` : `b = ${number(b.b, 3)} ± ${number(b.error, 2)} over ${many(b.points, "event")} from magnitude ${number(b.complete_from, 3)} on (maximum likelihood).`;
  return figure({
    title: "Size distribution", caption: `How many events have at least this potency (slip times area). ${words}`,
    x: { label: "potency (m³)", kind: "log", tick: powerTick }, y: { kind: "log", label: "Events at least as large", tick: (v) => count(v) },
    lines: [{ kind: "dots", colour: "run", x: events.at_least, y: events.count }],
    readout: (i) => `${many(events.count[i], "event")} of at least ${number(events.at_least[i], 3)} m³`,
    table: { n: events.at_least.length, caption: "size distribution", columns: [["Potency (m³)", (i) => number(events.at_least[i], 4)], ["Events at least as large", (i) => count(events.count[i])]] },
  });
}

function eventsSection(data) {
  const events = data.events, cut = events.cut.filter((c) => c > 0).length;
  const thinned = events.time.length < events.all ? ` ${count(events.time.length)} of them are drawn: the largest, and of the others every so many.` : "";
  const section = openSection("events", "Events", `${many(events.all, "event")} in the catalogue${cut ? `, ${count(cut)} of those drawn cut by the ends of the run` : ""}.${thinned}`);
  section.append(element("div", { class: "pair" }, eventTime(events), eventSizes(events)));
  return section;
}
