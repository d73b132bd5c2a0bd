// SPDX-License-Identifier: GPL-3.0-or-later
// Readings of a slope: how they moved, what drove them, the level, and the time left as forecast.
"use strict";

const READINGS_LEAD = "Displacement as it was read, outliers and resets of the sensor taken out; the rate between readings looks back only. The time axis can be turned, above, to the time left before the end.";

const beforeLast = (times) => times.map((t) => Math.max(0, page.clock.last - t));

const dotted = (series, words, more = {}) => ({ kind: "dots", colour: "seen", time: series.time, before: beforeLast(series.time), y: series.value, words, ...more });

// How far ahead of the last issue its methods see, in the middle.
function foreseen(data) {
  const { forecasts: f } = data, last = f.forecast[f.forecast.length - 1] || [];
  const left = last.filter((one, m) => one[ISSUED] && !f.methods[m].baseline && one[LEFT] > 0).map((one) => one[LEFT]).sort((x, y) => x - y);
  return left.length ? 1.3 * left[Math.floor(left.length / 2)] : 0;
}

// All charts of the readings have one axis, which takes in what is forecast and the failure where that is near.
function readingsAxis(data) {
  const { time } = data.readings.moved, first = time[0], last = time[time.length - 1], near = 0.35 * (last - first), { failure } = page.clock;
  const ahead = Math.max(Math.min(near, foreseen(data)), failure > last && failure - last < near ? failure - last : 0);
  return { clock: true, range: [first, last > first ? last + ahead : first + 1] };
}

// Each level from its time of issue to the next one; the last to the end of the axis.
function levelSpans(data) {
  const { alarm } = data, list = [];
  if (!alarm) return list;
  alarm.level.forEach((level, i) => {
    const to = alarm.time[i + 1] ?? Math.max(page.clock.last, alarm.time[i]), last = list[list.length - 1];
    if (level === null) return;
    if (last && last.level === level && last.to === alarm.time[i]) last.to = to;
    else list.push({ from: alarm.time[i], to, level });
  });
  return list;
}

const levelNames = (data) => data.alarm.meanings.split(" ");

// The levels that occur, by their names: colour alone says nothing.
function levelLegend(data) {
  if (!data.alarm) return [];
  const seen = new Set(data.alarm.level);
  return levelNames(data).map((name, k) => seen.has(k) && [`level: ${name}`, `level l-${k}`]).filter(Boolean);
}

const readAt = (series, i, words) => `${moment(page.clock, series.time[i])}, ${beforeEnd(page.clock, Math.max(0, page.clock.last - series.time[i]))}: ${words}`;

const overTime = (series, caption, columns) => ({ n: series.time.length, caption, columns: [["Time", (i) => moment(page.clock, series.time[i])], ...columns] });

function movedChart(data) {
  const { moved } = data.readings, unit = scaledLengths(Math.max(...extent([moved.value]).map(Math.abs)));
  return figure({
    title: "Displacement", caption: data.readings.falling ? "The readings fall: what is shown is their negative." : "",
    x: readingsAxis(data), y: { kind: "linear", label: `Displacement (${unit.unit})`, tick: unit.tick, scale: unit.scale },
    lines: [{ ...dotted(moved), kind: "line", thin: true, colour: "quiet" }, dotted(moved, undefined, { name: "reading" })], read: 1,
    marks: marksOf(data), bands: [], levels: levelSpans(data), shows: "window", legend: [...windowLegend(data), ...levelLegend(data)],
    readout: (i) => readAt(moved, i, length(moved.value[i])),
    table: overTime(moved, "displacement", [["Displacement", (i) => length(moved.value[i])]]),
  });
}

// Of the units of a rate the first in which the largest is one or more.
function rateUnit(high) {
  const units = [["m/s", 1], ["m/day", 1 / DAY], ["mm/day", 1e-3 / DAY], ["mm/year", 1e-3 / YEAR]];
  const [unit, scale] = units.find(([name, s]) => high >= s && (name !== "m/s" || high >= 0.01)) || units[3];
  return { unit, scale, tick: (v, more = 0) => number(v / scale, 5 + more) };
}

function speedChart(data) {
  const { rate: speed } = data.readings, unit = rateUnit(extent([speed.value])[1]);
  return figure({
    title: "Rate", caption: "Between readings. The button log turns the axis.",
    x: readingsAxis(data), y: { kind: "linear", label: `Rate (${unit.unit})`, tick: unit.tick, scale: unit.scale },
    lines: [dotted(speed)], marks: marksOf(data), levels: levelSpans(data),
    readout: (i) => readAt(speed, i, rate(speed.value[i])),
    table: overTime(speed, "rate", [["Rate", (i) => rate(speed.value[i])], ["m/s", (i) => number(speed.value[i])]]),
  });
}

// Slow times would press the last ones together: the axis holds nine tenths of all.
function inverseSpeedChart(data) {
  const { rate: speed } = data.readings, y = speed.value.map((v) => (v > 0 ? 1 / v : null));
  const sorted = y.filter((v) => v !== null).sort((a, b) => a - b), top = sorted.length ? 1.1 * sorted[Math.floor(0.9 * (sorted.length - 1))] : 1;
  const unit = inverseUnit(top);
  return figure({
    title: "Inverse rate", caption: "Where it falls along a line to zero, the line meets the time of failure (Fukuzono 1985). Rates of zero or less have no inverse; the axis holds nine tenths of the others.",
    x: readingsAxis(data), y: { kind: "linear", label: `1/rate (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: [0, top] },
    lines: [{ ...dotted(speed), y }], marks: marksOf(data), bands: [], levels: levelSpans(data), shows: "window", legend: windowLegend(data),
    readout: (i) => readAt(speed, i, y[i] === null ? "–" : unit.words(y[i])),
    table: overTime(speed, "inverse rate", [[`1/rate (${unit.unit})`, (i) => (y[i] === null ? "–" : unit.tick(y[i]))]]),
  });
}

// What falls now and then, as rain does, stands on the axis as bars; what is always there is a line.
function driverChart(data, driver) {
  const { series, unit } = driver, zeros = series.value.filter((v) => v === 0).length;
  const bars = zeros > series.value.length / 4 && extent([series.value])[0] >= 0;
  const flat = (make) => series.time.flatMap((t, i) => make(t, series.value[i]));
  const stems = { kind: "line", colour: "run", time: flat((t) => [t, t, null]), y: flat((t, v) => [0, v, null]) };
  stems.before = stems.time.map((t) => (t === null ? null : Math.max(0, page.clock.last - t)));
  const line = { ...dotted(series), kind: "line", colour: "run", thin: !bars };
  const words = (i) => `${number(series.value[i])}${unit && unit !== "1" ? `${THIN}${unit}` : ""}`;
  return figure({
    title: driver.long_name && driver.long_name.length < 60 ? driver.long_name : driver.name, caption: driver.comment,
    x: readingsAxis(data), y: { kind: "linear", label: `${driver.name}${unit && unit !== "1" ? ` (${unit})` : ""}`, tick: plain(5), ...(bars && { range: [0, extent([series.value])[1] || 1] }) },
    lines: bars ? [stems, { ...line, kind: "none" }] : [line], read: bars ? 1 : 0, marks: marksOf(data), levels: levelSpans(data),
    readout: (i) => readAt(series, i, words(i)),
    table: overTime(series, driver.name, [[driver.name, words]]),
  });
}

function levelStepChart(data) {
  const { alarm } = data, names = levelNames(data);
  const tail = alarm.time[alarm.time.length - 1] < page.clock.last;
  const time = tail ? [...alarm.time, page.clock.last] : alarm.time, y = tail ? [...alarm.level, alarm.level[alarm.level.length - 1]] : alarm.level;
  return figure({
    title: "Level", caption: alarm.comment || "At each time of issue, from nothing later.", height: 200,
    x: readingsAxis(data), y: { kind: "linear", fixed: true, label: "Level", range: [-0.25, names.length - 0.75], tick: (v) => (Number.isInteger(v) ? names[v] ?? "" : "") },
    lines: [{ kind: "step", colour: "run", time, before: beforeLast(time), y }], marks: marksOf(data), bands: levelSpans(data), legend: levelLegend(data),
    readout: (i) => readAt({ time }, i, names[y[i]] ?? "–"),
    table: overTime(alarm, "level", [["Level", (i) => names[alarm.level[i]] ?? "–"]]),
  });
}

function readingsSection(data) {
  const section = openSection("readings", "Readings", READINGS_LEAD), { readings: r } = data;
  section.append(movedChart(data));
  if (data.alarm) section.append(levelStepChart(data));
  if (r.rate?.time.length) section.append(element("div", { class: "pair" }, speedChart(data), inverseSpeedChart(data)));
  for (const driver of r.drivers.filter((d) => d.series.time.length)) section.append(driverChart(data, driver));
  const noise = r.noise === null ? "" : ` Their noise is about ${length(r.noise, 2)}.`;
  section.append(element("p", { class: "note" }, `${r.name}: ${many(r.moved.all, "reading")}.${noise} ${r.attribution}`));
  return section;
}

// Of all methods the intervals of their pooled time, else the span of their times and of their 90 % intervals; of one its own.
function leftBands(f, method) {
  const spanned = method < 0 && !f.pooled, of = method < 0 ? ", all methods" : "";
  const outer = { kind: "area", colour: "fast", name: spanned ? "their 90 % intervals" : `90 % interval${of}`, time: [], low: [], high: [], y: [] };
  const inner = { ...outer, inner: true, name: spanned ? "from the first to the last" : `50 % interval${of}`, time: [], low: [], high: [], y: [] };
  f.issue.forEach((from, i) => {
    if (method < 0 && f.pooled) {
      for (const [band, low, high] of [[outer, EARLY, LAST], [inner, SOON, LATE]]) {
        band.time.push(from);
        band.low.push(pooled(f, i)?.[low] ?? null);
        band.high.push(pooled(f, i)?.[high] ?? null);
      }
      return;
    }
    const rows = f.forecast[i].filter((one, m) => one[ISSUED] && one[LOW90] !== null && (method < 0 ? !f.methods[m].baseline : m === method));
    for (const [band, low, high] of [[outer, LOW90, HIGH90], [inner, method < 0 ? LEFT : LOW50, method < 0 ? LEFT : HIGH50]]) {
      const never = rows.some((one) => one[high] === null);
      band.time.push(from);
      band.low.push(rows.length ? Math.max(0, Math.min(...rows.map((one) => one[low] ?? 0))) : null);
      band.high.push(!rows.length || never ? null : Math.max(...rows.map((one) => one[high])));
    }
  });
  for (const band of [outer, inner]) Object.assign(band, { y: band.low, before: beforeLast(band.time) });
  return [outer, inner];
}

// The time left by each forecast over its time of issue, and what was left in truth where that is known.
function leftSpec(f, method) {
  const dots = { ...issuedDots(f, method, (_, left) => left), name: "forecast", colour: "fast" };
  delete dots.low, delete dots.high;
  const { failure } = page.clock, known = failure !== null;
  const ends = f.issue.filter((t) => t < failure);
  const truth = known ? [{ name: "what was left", kind: "line", colour: "run", time: [...ends, failure], y: [...ends.map((t) => failure - t), 0] }] : [];
  for (const line of truth) line.before = beforeLast(line.time);
  const middles = method < 0 ? f.issue.map((_, i) => pooled(f, i)?.[MIDDLE] ?? null) : [];
  const middle = { name: "middle of all methods", kind: "line", colour: "fast", time: f.issue, before: beforeLast(f.issue), y: middles };
  const lives = [...dots.y, ...middles].filter((v) => v !== null).sort((a, b) => a - b), usual = lives[Math.floor(lives.length / 2)] ?? 0;
  const first = known && dots.time.length ? failure - dots.time[0] : 0;
  const top = 1.6 * Math.max(usual, first) || 1, [unit, scale] = SPANS.find(([, s]) => top >= 2 * s) || SPANS[SPANS.length - 1];
  return {
    title: "Time left, as forecast", x: { clock: true, range: known ? [f.issue[0], Math.max(failure, f.issue[f.issue.length - 1])] : undefined },
    y: { kind: "linear", label: `Time left (${unit})`, range: [0, top], scale, tick: (v, more = 0) => number(v / scale, 4 + more) },
    lines: [...leftBands(f, method), ...truth, dots, ...(middles.some((y) => y !== null) ? [middle] : [])], read: 2 + truth.length, marks: marksOf(page.data), levels: levelSpans(page.data),
    caption: `Predicted time of failure less the time of issue. ${known ? "A forecast on the line is right; above it is late. " : ""}${method < 0 ? `Dots: each method. ${f.pooled ? "Shaded: all methods together, darker 50 %, light 90 %." : "Darker: from the first to the last of their times; light: their 90 % intervals together."} Choose a method to see its own.` : "Intervals are calibrated on simulated failures."}`,
    readout: (i) => readForecast(f, dots, i),
  };
}

// What of it is a sentence stands first.
const sentence = (data) => data.verdict.findIndex(([, text]) => text.split(" ").length > 3);
const besides = (data) => data.verdict.filter((_, i) => i !== sentence(data));

// First lines of the page: what the file says of the slope, else what can be read off it.
function readingsVerdict(data) {
  if (sentence(data) >= 0) return data.verdict[sentence(data)][1];
  const { moved, rate: speed } = data.readings, n = moved.time.length, f = data.forecasts, last = f.forecast[f.forecast.length - 1];
  const issued = last.filter((one, m) => one[ISSUED] && !f.methods[m].baseline).length, all = f.methods.filter((m) => !m.baseline).length;
  const now = speed?.value.length ? `, last at ${rate(speed.value[speed.value.length - 1])}` : "";
  const forecast = issued ? `${issued} of ${all} methods forecast a failure` : `no method forecasts a failure: ${last.find((one) => one[REASON])?.[REASON] || "none is issued"}`;
  return `It moved ${length(moved.value[n - 1] - moved.value[0], 3)} in ${span(moved.time[n - 1] - moved.time[0], 3)}${now}. At ${moment(page.clock, f.issue[f.issue.length - 1])} ${forecast}.`;
}

const isNumber = (text) => text !== "" && Number.isFinite(Number(text));

const spaced = (name) => name.replace(/^verdict_?/, "").replace(/_/g, " ");

function readingsFacts(data) {
  const a = data.about, { moved, rate: speed } = data.readings, { alarm } = data, list = [];
  if (alarm) list.push(["Level", levelNames(data)[alarm.level[alarm.level.length - 1]] ?? "–", `at ${moment(page.clock, alarm.time[alarm.time.length - 1])}`, alarm.level[alarm.level.length - 1]]);
  list.push(["Last reading", moment(page.clock, page.clock.last), many(moved.all, "reading")]);
  list.push(["Displacement", length(moved.value[moved.value.length - 1], 4)]);
  if (speed?.value.length) list.push(["Rate", rate(speed.value[speed.value.length - 1]), "over the last step"]);
  if (a.failed) list.push(["Failed", moment(page.clock, a.failure_time_s), "as known afterwards"]);
  for (const [name, text] of besides(data)) if (isNumber(text)) list.push([spaced(name) || name, text]);
  return list;
}

// What the file says at more length.
function verdictLines(data) {
  const list = element("ul", { class: "said" });
  for (const [name, text] of besides(data)) {
    if (!isNumber(text)) list.append(element("li", {}, element("strong", {}, `${spaced(name) || name}: `), text));
  }
  return list;
}
