// SPDX-License-Identifier: GPL-3.0-or-later
// The motion: creep curve, slip rate, inverse rate; forces; the integrator.
"use strict";

const MOTION_LEAD = "Mean slip and slip rate over the contact cells. The time axis can be turned, above, to the time left before the end, where every decade of the acceleration has the same width.";

// A fit without another series brings its own readings.
const seriesName = (data) => (data.fit?.name === data.series.name ? "readings fitted" : data.series.name);

// Readings moved onto the run's slip by their best constant offset; those of a point, or of the whole.
function readings(data, point) {
  const s = data.series;
  if (!s || s.point !== point || !s.displacement.some((v) => v !== null)) return [];
  const y = s.displacement.map((v) => (v === null ? null : v - (s.offset ?? 0)));
  return [{ name: seriesName(data), kind: "dots", colour: "seen", time: s.time, y, follows: true, words: (i) => `reading ${length(y[i])}` }];
}

function seenRates(data, point) {
  const s = data.series;
  if (!s || s.point !== point || !s.rate.length) return [];
  return [{ name: s.derived ? `${seriesName(data)}, between readings` : seriesName(data), kind: "dots", colour: "seen", time: s.rate_time, y: s.rate, follows: true,
    words: (i) => `reading ${rate(s.rate[i])}` }];
}

function marksOf(data) {
  const failure = data.about.failed ? [{ x: page.clock.failure, label: "failure" }] : [];
  return data.fit ? [...failure, { x: data.fit.until, label: "fitted up to here", quiet: true }] : failure;
}

// What the shades of the window mean, where there is one.
const windowWords = (f) => (f.pooled ? ["failure with a chance of 50 %", "of 90 %"] : ["window of the forecasts", "their 90 % intervals"]);
const windowLegend = (data) => (data.forecasts ? [[windowWords(data.forecasts)[0], "band inner"], [windowWords(data.forecasts)[1], "band"]] : []);

function scaledLengths(high) {
  const [unit, scale] = LENGTHS.find(([, s]) => high >= s) || LENGTHS[LENGTHS.length - 1];
  return { unit, scale, tick: (v, more = 0) => number(v / scale, 5 + more) };
}

// In time the slip of the failure itself would flatten the creep: the axis ends just before it.
function slipRange(data, lines) {
  const { time } = data.motion, [low, high] = extent(lines.map((l) => l.y));
  if (page.axis === "before" || !data.about.failed) return [low, high];
  const end = time[0] + 0.997 * (time[time.length - 1] - time[0]);
  const [, creep] = extent(lines.map((l) => (l.follows ? l.y : l.y.filter((_, i) => l.time[i] <= end))));
  return [low, creep > low ? low + 1.15 * (creep - low) : high];
}

function creepRange(data, seen) {
  const { time, slip } = data.motion;
  return slipRange(data, [{ time, y: slip }, ...seen, ...fitCore(data).map((y) => ({ y, follows: true }))]);
}

function creepChart(data) {
  const m = data.motion, seen = readings(data);
  const unit = scaledLengths(creepRange(data, seen)[1]);
  const beside = seen.length && data.series.offset !== null
    ? ` Readings are moved by ${length(-data.series.offset, 3)}, their best constant offset; they leave the run by ${length(data.series.slip_rms, 3)} rms.` : "";
  const fitted = fitOf(data) ? ` ${fitWords(data.fit)}` : "";
  return figure({
    title: "Creep curve", caption: `Mean slip since the start.${data.about.failed ? " Over time the axis ends just before the slip of the failure itself." : ""}${beside}${fitted}`,
    x: { clock: true, reach: fitReach(data) }, y: { kind: "linear", label: `Slip (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: () => creepRange(data, seen) },
    read: fitSlip(data).length,
    lines: [...fitSlip(data), { name: "run", kind: "line", colour: "run", time: m.time, before: m.before, y: m.slip }, ...seen],
    marks: marksOf(data), bands: [], shows: "window", legend: windowLegend(data), spans: fitSpans(data),
    readout: (i) => `${moment(page.clock, m.time[i])}, ${beforeEnd(page.clock, m.before[i])}: slip ${length(m.slip[i])}`,
    table: { n: m.time.length, caption: "slip and slip rate", columns: [...clockColumns(m), ["Mean slip", (i) => length(m.slip[i])],
      ["Mean rate", (i) => rate(m.rate[i])], ["Fastest cell", (i) => rate(m.max_rate[i])]] },
  });
}

function rateChart(data) {
  const m = data.motion;
  const many = m.max_rate.some((v, i) => v > m.rate[i] * 1.0001);
  const fastest = many ? [{ name: "fastest cell", kind: "line", thin: true, colour: "quiet", time: m.time, before: m.before, y: m.max_rate }] : [];
  return figure({
    title: "Slip rate", caption: many ? "Logarithmic. Mean over the contact cells, and of the fastest one." : "Logarithmic.",
    x: { clock: true, reach: fitReach(data) }, y: { kind: "log", label: "Slip rate (m/s)", tick: powerTick },
    read: fastest.length + fitRates(data).length,
    lines: [...fitRates(data), ...fastest, { name: "mean", kind: "line", colour: "run", time: m.time, before: m.before, y: m.rate }, ...seenRates(data)],
    marks: marksOf(data),
    readout: (i) => `${moment(page.clock, m.time[i])}, ${beforeEnd(page.clock, m.before[i])}: ${rate(m.rate[i])}` +
      (many ? `, fastest cell ${rate(m.max_rate[i])}` : ""),
    table: { n: m.time.length, caption: "slip rate", columns: [...clockColumns(m), ["Mean (m/s)", (i) => number(m.rate[i])],
      ["Mean", (i) => rate(m.rate[i])], ["Fastest cell (m/s)", (i) => number(m.max_rate[i])]] },
  });
}

const powerTick = (v) => {
  const power = Math.log10(v);
  return Math.abs(power - Math.round(power)) < 1e-6 ? (Math.round(power) === 0 ? "1" : `10${raised(Math.round(power))}`) : number(v, 2);
};

// Of the units of 1/rate the first in which the largest value is half of one or more.
function inverseUnit(high) {
  const units = [["day/mm", 1 / (DAY * 1e3)], ["day/m", 1 / DAY], ["s/m", 1]];
  const [unit, factor] = units.find(([, f]) => high * f >= 0.5) || units[2];
  return { unit, scale: 1 / factor, tick: (v, more = 0) => number(v * factor, 4 + more), words: (v) => `${number(v * factor, 4)}${THIN}${unit}` };
}

function inverseChart(data) {
  const m = data.motion;
  const inverse = (list) => list.map((v) => (v > 0 ? 1 / v : null));
  const seen = seenRates(data).map((line) => ({ ...line, y: inverse(line.y), words: (i) => `reading ${unit.words(1 / line.y[i])}` }));
  const y = inverse(m.rate);
  const high = Math.max(extent([y])[1], seen.length ? extent(seen.map((s) => s.y))[1] : 0);
  const top = seen.length ? Math.min(high, 6 * extent([y])[1]) : high;
  const unit = inverseUnit(top);
  return figure({
    title: "Inverse slip rate", caption: "Where it falls along a line to zero, the line meets the time of failure (Fukuzono 1985).",
    x: { clock: true, reach: fitReach(data) }, y: { kind: "linear", label: `1/rate (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: [0, top] },
    lines: [{ name: "run", kind: "line", colour: "run", time: m.time, before: m.before, y }, ...seen],
    marks: marksOf(data), bands: [], shows: "window", legend: windowLegend(data), spans: fitSpans(data),
    readout: (i) => `${moment(page.clock, m.time[i])}, ${beforeEnd(page.clock, m.before[i])}: ${y[i] === null ? "–" : unit.words(y[i])}`,
    table: { n: m.time.length, caption: "inverse slip rate", columns: [...clockColumns(m), [`1/rate (${unit.unit})`, (i) => (y[i] === null ? "–" : unit.tick(y[i]))]] },
  });
}

function motionSection(data) {
  const section = openSection("motion", "Motion", MOTION_LEAD);
  section.append(creepChart(data));
  section.append(element("div", { class: "pair" }, rateChart(data), inverseChart(data)));
  if (data.series && !data.series.point) section.append(seriesNote(data.series));
  return section;
}

function seriesNote(series) {
  const parts = [`${page.data.fit?.name === series.name ? "Readings of " : ""}${series.name}: ${page.data.fit?.name === series.name ? count(series.readings) : many(series.readings, "reading")}, ${count(series.outside)} outside the run.`];
  if (series.rate_rms_log10 !== null) parts.push(`Measured and modelled rates differ by a factor of ${number(10 ** series.rate_rms_log10, 2)} rms over ${many(series.rate_readings, "reading")}.`);
  if (series.falling) parts.push("The readings fall: their rate is that of their negative.");
  if (series.attribution) parts.push(series.attribution);
  return element("p", { class: "note" }, parts.join(" "));
}

function forcesSection(data) {
  const f = data.forces;
  const section = openSection("forces", "Load", "Shear over normal force on the whole interface, and the normal force that pore pressure leaves.");
  const row = element("div", { class: "pair" });
  row.append(figure({
    title: "Apparent friction", caption: "Q/P with the total normal force.", x: { clock: true },
    y: { kind: "linear", label: "Q/P", tick: plain(5) },
    lines: [{ kind: "line", colour: "run", time: f.time, before: f.before, y: f.friction }],
    readout: (i) => `${moment(page.clock, f.time[i])}: Q/P ${number(f.friction[i], 5)}`,
    table: { n: f.time.length, caption: "forces", columns: [...clockColumns(f), ["Q/P", (i) => number(f.friction[i], 5)],
      ["Shear force", (i) => force(f.shear[i])], ["Normal force", (i) => force(f.normal[i])], ["Effective normal force", (i) => force(f.effective[i])]] },
  }));
  const [low, high] = extent([f.effective]);
  if (high - low > 1e-6 * Math.abs(high)) {
    row.append(figure({
      title: "Effective normal force", caption: "Normal force less pore pressure times nominal area.", x: { clock: true },
      y: { kind: "linear", label: "Force", tick: (v, more = 0) => force(v, 4 + more) },
      lines: [{ kind: "line", colour: "run", time: f.time, before: f.before, y: f.effective }],
      readout: (i) => `${moment(page.clock, f.time[i])}: ${force(f.effective[i], 5)}`,
      table: { n: f.time.length, caption: "effective normal force", columns: [...clockColumns(f), ["Force", (i) => force(f.effective[i], 5)]] },
    }));
  }
  section.append(row);
  return section;
}

function solverChart(s, title, key, axis, words, caption) {
  return figure({
    title, caption, x: { clock: true }, y: axis,
    lines: [{ kind: key === "order" ? "step" : "line", colour: "run", time: s.time, before: s.before, y: s[key], thin: true }],
    readout: (i) => `${moment(page.clock, s.time[i])}, ${beforeEnd(page.clock, s.before[i])}: ${words(s[key][i])}`,
    table: { n: s.time.length, caption: title.toLowerCase(), columns: [...clockColumns(s), [title, (i) => words(s[key][i])]] },
  });
}

function solverCharts(s) {
  const pair = element("div", { class: "pair" });
  pair.append(solverChart(s, "Step size", "step", { kind: "log", label: "Step (s)", tick: powerTick }, span, "Of the step that ended at each record."));
  if (s.order.some((v) => v !== null)) {
    const most = extent([s.order])[1];
    pair.append(solverChart(s, "Order", "order", { kind: "linear", fixed: true, label: "Order", tick: (v) => (Number.isInteger(v) ? String(v) : ""), range: [0, most + 0.5] }, plain(3), "Of the method in that step."));
  }
  if (s.residual.filter((v) => v > 0).length > s.residual.length / 2) {
    pair.append(solverChart(s, "Balance residual", "residual", { kind: "log", label: "Relative", tick: powerTick }, plain(3), "Worst cell: |q − Kδ − pf − ηv| over f₀p. A measure of accuracy that costs nothing."));
  }
  pair.append(solverChart(s, "Evaluations", "evaluations", { kind: "linear", label: "Since the start", tick: (v) => count(v) }, count, "Of the right-hand side."));
  return pair;
}

function solverSection(data) {
  const s = data.solver, a = data.about;
  const section = openSection("solver", "Integration", "How the solver went through the run, and how far it drifted from the traction balance that it solves.");
  if (s.step.filter((v) => v !== null).length > 2) section.append(solverCharts(s));
  const rows = [["Steps", a.steps], ["Evaluations", a.rhs_evaluations], ["Newton iterations", a.newton_iterations], ["Linear solves", a.linear_solves],
    ["Error-test failures", a.error_test_fails], ["Nonlinear failures", a.nonlinear_fails], ["Restarts", a.restarts]].filter(([, v]) => v !== undefined);
  if (rows.length) {
    section.append(element("div", { class: "plain" }, bareTable("Counts of the whole run", rows.length,
      [["What", (i) => rows[i][0]], ["Number", (i) => count(rows[i][1])]])));
  }
  return section;
}
