// SPDX-License-Identifier: GPL-3.0-or-later
// The places that a run was watched at: their motion, and where they are.
"use strict";

// Apart from each other by day and night, and to most eyes in this order.
const POINT_COLOURS = ["#2f7fd0", "#d9722e", "#2a9d7f", "#b45fc0", "#c29a1b", "#d1495b", "#4fa3b8", "#8a8f3c"];

const pointLines = (points, key) => points.name.map((name, k) => ({ name, kind: "line", colour: "run", stroke: POINT_COLOURS[k % POINT_COLOURS.length],
  dash: Math.floor(k / POINT_COLOURS.length) % 2 === 1, time: points.time, before: points.before, y: points[key][k] }));

const jointLine = (data, key) => ({ name: "mean of the joint", kind: "line", thin: true, colour: "quiet", time: data.motion.time, before: data.motion.before, y: data.motion[key] });

// The first few points in words.
const pointWords = (points, key, words, i) => points.name.slice(0, 4).map((name, k) => `${name} ${words(points[key][k][i])}`).join(", ");

function pointTable(points, key, caption, words) {
  return { n: points.time.length, caption, columns: [...clockColumns(points), ...points.name.map((name, k) => [name, (i) => words(points[key][k][i])])] };
}

const pointReadout = (points, key, words) => (i) => `${moment(page.clock, points.time[i])}, ${beforeEnd(page.clock, points.before[i])}: ${pointWords(points, key, words, i)}`;

// Which point the series or fit beside the run is of; null: none.
const seenPoint = (data) => data.series?.point ?? data.fit?.point ?? null;

function pointSlip(data) {
  const { points } = data, of = seenPoint(data), seen = readings(data, of), fit = fitSlip(data, of);
  const lists = [...points.slip.map((y) => ({ time: points.time, y })), ...fitCore(data, of).map((y) => ({ y, follows: true }))];
  const ends = () => slipRange(data, [...lists, ...seen]), unit = scaledLengths(ends()[1]);
  const beside = seen.length && data.series.offset !== null
    ? ` Readings are of ${data.series.point}, moved by ${length(-data.series.offset, 3)}, their best constant offset; they leave the run by ${length(data.series.slip_rms, 3)} rms.` : "";
  return figure({
    title: "Slip at the points", caption: `Since the start.${beside}${fit.length ? ` ${fitWords(data.fit)}` : ""}`,
    x: { clock: true, reach: fit.length ? fitReach(data) : [] }, read: fit.length,
    y: { kind: "linear", label: `Slip (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: ends },
    lines: [...fit, ...pointLines(points, "slip"), jointLine(data, "slip"), ...seen], marks: marksOf(data),
    readout: pointReadout(points, "slip", length), table: pointTable(points, "slip", "slip at the points", length),
  });
}

function pointRate(data) {
  const { points } = data, of = seenPoint(data), fit = fitRates(data, of);
  return figure({
    title: "Slip rate at the points", caption: "Logarithmic.", x: { clock: true, reach: fit.length ? fitReach(data) : [] }, read: fit.length, y: { kind: "log", label: "Slip rate (m/s)", tick: powerTick },
    lines: [...fit, ...pointLines(points, "rate"), jointLine(data, "rate"), ...seenRates(data, of)], marks: marksOf(data),
    readout: pointReadout(points, "rate", rate), table: pointTable(points, "rate", "slip rate at the points", rate),
  });
}

function placeTable(data) {
  const { points: p } = data, last = p.time.length - 1, line = data.about.grid_ny === 1;
  const place = (x, y) => (line ? length(x, 4) : `${length(x, 4)}, ${length(y, 4)}`);
  const seen = (k) => (p.cells[k] > 1 ? `mean of ${count(p.cells[k])} cells`
    : p.distance[k] > 0 ? `the nearest cell, ${length(p.distance[k], 3)} away` : "its own cell");
  return element("div", { class: "plain" }, bareTable("Where they are, and what is seen of them", p.name.length, [
    ["Point", (k) => p.name[k], "text"], [line ? "x" : "x, y", (k) => place(p.x[k], p.y[k])], ["Nearest contact cell", (k) => place(p.cell_x[k], p.cell_y[k])],
    ["What is seen", seen], ["Slip at the end", (k) => length(p.slip[k][last])], ["Rate at the end", (k) => rate(p.rate[k][last])]]));
}

function pointsSection(data) {
  const { points } = data, few = points.all > points.name.length ? ` The first ${count(points.name.length)} of ${count(points.all)} are drawn.` : "";
  const section = openSection("points", "Points", `What prisms at these places would show: the slip of the contact cells there.${few}`);
  section.append(element("div", { class: "pair" }, pointSlip(data), pointRate(data)), placeTable(data));
  if (data.series?.point) section.append(seriesNote(data.series));
  return section;
}

// Marks of the points on a map of squares, from its lower left corner; names where they are few.
function pointMarks(data, wide, high) {
  const { points } = data;
  if (!points) return [];
  return points.name.map((name, k) => {
    const mark = element("span", { class: "point", title: name }, ...(points.name.length <= 12 ? [name] : []));
    mark.style.left = `${(100 * points.x[k]) / wide}%`;
    mark.style.bottom = `${(100 * points.y[k]) / high}%`;
    if (points.x[k] > 0.6 * wide) mark.classList.add("left");
    return mark;
  });
}

// The same along a line.
const pointPlaces = (data) => (data.points ? data.points.name.map((name, k) => ({ x: data.points.x[k], label: name })) : []);
