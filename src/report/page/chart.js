// SPDX-License-Identifier: GPL-3.0-or-later
// A chart: lines, dots, bars and bands over a clock or any axis, drawn as SVG, read off by pointer
// or keys.
"use strict";

const page = { data: null, clock: null, axis: "time", charts: [] };

const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function element(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

// A clock axis is turned as the page's are, or stays as it is.
const turned = (spec) => (spec.x.axis || page.axis) === "before";

// A line's places on a clock axis: times, or times before the end.
function clockValues(spec, line) {
  if (!turned(spec)) return line.time;
  return line.before || line.time.map((t) => (t === null ? null : page.clock.last - t));
}

const xValues = (spec, line) => (spec.x.clock ? clockValues(spec, line) : line.x);

function clockScale(spec, width) {
  const lists = spec.lines.filter((l) => !l.follows).map((l) => clockValues(spec, l));
  if (turned(spec)) return remaining(spec.x.before || extentPositive(lists), width / 74);
  const ends = spec.x.range || extent(lists);
  return page.clock.dated ? calendar(ends, width / 84, page.clock.start) : elapsed(ends, width / 84);
}

// Dots stand clear of the edges.
function widened([low, high], by) {
  return low > 0 ? [low / (high / low) ** by, high * (high / low) ** by] : [low, high];
}

function makeScale(given, lists, most) {
  const axis = typeof given.range === "function" ? { ...given, range: given.range() } : given;
  if (axis.kind === "clock") return page.clock.dated ? calendar(axis.range, most, page.clock.start) : elapsed(axis.range, most);
  if (axis.kind === "spans") return spans(axis.range || extentPositive(lists), most);
  if (axis.kind === "log") return logarithmic(axis.range || widened(extentPositive(lists), axis.clear || 0), most, axis.tick);
  return linear(axis.range || extent(lists), most, axis.tick, axis.scale);
}

function clockLabel(spec, scale) {
  if (turned(spec)) return `time before ${page.clock.end}`;
  if (page.clock.dated) return `date (UTC), ${date(page.clock.start + scale.low, "day")} to ${date(page.clock.start + scale.high, "day")}`;
  return `time since the start (${scale.unit})`;
}

// Room around the plot, by the longest label.
function layOut(spec, width, height) {
  const y = makeScale(spec.y, spec.lines.flatMap((l) => (l.low ? [l.y, l.low, l.high] : [l.y])).concat(
    (spec.marks || []).filter((m) => m.y !== undefined).map((m) => [m.y])), height / 46);
  const left = 12 + 6.9 * Math.max(...y.ticks.map((t) => String(t.label).length), 2);
  const box = { left, right: width - 14, top: 26, bottom: height - 40 };
  const inner = box.right - box.left;
  const x = spec.x.clock ? clockScale(spec, inner) : makeScale(spec.x, spec.lines.map((l) => l.x), inner / 74);
  return {
    box, x, y,
    px: (v) => box.left + inner * x.at(v),
    py: (v) => box.bottom - (box.bottom - box.top) * y.at(v),
  };
}

function drawAxes(spec, plot, group) {
  const { box, x, y } = plot;
  for (const t of y.ticks) {
    const at = plot.py(t.value);
    group.append(svg("line", { class: "grid", x1: box.left, x2: box.right, y1: at, y2: at }));
    group.append(svg("text", { x: box.left - 7, y: at + 4, "text-anchor": "end" }, String(t.label)));
  }
  let free = -Infinity;
  for (const t of [...x.ticks].sort((a, b) => plot.px(a.value) - plot.px(b.value))) {
    const at = plot.px(t.value), half = 3.5 * String(t.label).length;
    group.append(svg("line", { class: "tick", x1: at, x2: at, y1: box.bottom, y2: box.bottom + 5 }));
    if (at - half < free + 6 || at + half > box.right + 14) continue;
    group.append(svg("text", { x: at, y: box.bottom + 18, "text-anchor": "middle" }, String(t.label)));
    free = at + half;
  }
  group.append(svg("line", { class: "axis-line", x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom }));
  group.append(svg("text", { class: "name", x: 0, y: 12 }, spec.y.label));
  const label = spec.x.clock ? clockLabel(spec, x) : spec.x.label;
  group.append(svg("text", { x: box.right, y: box.bottom + 35, "text-anchor": "end" }, label));
}

// Path of a line; gaps where a value is missing. `stepped`: a value holds until the next.
function pathOf(plot, xs, ys, stepped) {
  let path = "", pen = false, last = 0;
  for (let i = 0; i < xs.length; i++) {
    const px = plot.px(xs[i]), py = ys[i] === null ? NaN : plot.py(ys[i]);
    if (!Number.isFinite(px) || !Number.isFinite(py)) {
      pen = false;
    } else {
      const turn = stepped && pen ? `L${px.toFixed(1)} ${last.toFixed(1)}` : "";
      const here = `${px.toFixed(1)} ${py.toFixed(1)}`;
      path += pen ? `${turn}L${here}` : `M${here}h0`; // h0: a point that stands alone is seen
      pen = true;
      last = py;
    }
  }
  return path;
}

function drawDots(line, plot, xs, group) {
  for (let i = 0; i < xs.length; i++) {
    const x = plot.px(xs[i]), y = line.y[i] === null ? NaN : plot.py(line.y[i]);
    if (!Number.isFinite(x) || !Number.isFinite(y) || x < plot.box.left - 1 || x > plot.box.right + 1) continue;
    if (line.low && line.low[i] !== null) {
      const low = plot.py(Math.max(line.low[i], plot.y.low)), high = plot.py(Math.min(line.high[i] ?? Infinity, plot.y.high));
      group.append(svg("line", { class: `line thin c-${line.colour}`, x1: x, x2: x, y1: low, y2: high }));
    }
    const r = line.radius ? line.radius[i] : 2.6;
    group.append(svg("circle", { class: line.full ? `dot full f-${line.colour}` : `dot c-${line.colour}`,
      cx: x.toFixed(1), cy: y.toFixed(1), r: r.toFixed(1), opacity: line.full ? 0.5 : 1 }));
  }
}

function drawLines(spec, plot, group) {
  for (const line of spec.lines) {
    const xs = xValues(spec, line);
    if (line.kind === "dots") {
      drawDots(line, plot, xs, group);
    } else {
      const look = `line c-${line.colour}${line.dash ? " dash" : ""}${line.thin ? " thin" : ""}`;
      const path = svg("path", { class: look, d: pathOf(plot, xs, line.y, line.kind === "step") });
      if (line.stroke) path.style.stroke = line.stroke;
      group.append(path);
    }
  }
}

function bandPlaces(spec, plot, band) {
  const clock = spec.x.clock && turned(spec);
  const place = (v) => plot.px(clock ? Math.max(0, page.clock.last - v) : v);
  const clip = (v) => Math.min(plot.box.right, Math.max(plot.box.left, v));
  return [clip(place(band.from)), clip(place(band.to ?? Infinity) || plot.box.right)];
}

function drawBands(spec, plot, group) {
  for (const band of spec.bands || []) {
    const [from, to] = bandPlaces(spec, plot, band);
    if (to - from > 0.3) {
      group.append(svg("rect", { class: band.inner ? "band inner" : "band", x: from, width: to - from,
        y: plot.box.top, height: plot.box.bottom - plot.box.top }));
    }
  }
}

function markPlace(spec, plot, mark) {
  return plot.px(spec.x.clock && turned(spec) ? page.clock.last - mark.x : mark.x);
}

function drawMarks(spec, plot, group) {
  const { box } = plot;
  let row = 0; // labels of upright marks stand one below the other
  for (const mark of spec.marks || []) {
    const across = mark.y !== undefined;
    const at = across ? plot.py(mark.y) : markPlace(spec, plot, mark);
    if (!Number.isFinite(at) || (!across && (at < box.left - 1 || at > box.right + 1))) continue;
    const ends = across ? { x1: box.left, x2: box.right, y1: at, y2: at } : { x1: at, x2: at, y1: box.top, y2: box.bottom };
    group.append(svg("line", { class: "mark dash", ...ends }));
    if (!mark.label) continue;
    const near = at > (box.left + box.right) / 2;
    const place = across ? { x: box.left + 6, y: at - 5 } : { x: at + (near ? -6 : 6), y: box.top + 11 + 15 * row++, "text-anchor": near ? "end" : "start" };
    group.append(svg("text", { class: "mark-label", ...place }, mark.label));
  }
}

let clips = 0;

function draw(chart) {
  const { spec, frame } = chart;
  const width = Math.max(240, frame.clientWidth || 640);
  const height = spec.height || Math.round(Math.min(380, Math.max(230, width * 0.5)));
  const plot = layOut(spec, width, height);
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": spec.title });
  const clip = `clip${++clips}`, { box } = plot;
  picture.append(svg("clipPath", { id: clip }, svg("rect", { x: box.left - 4, y: box.top - 4,
    width: box.right - box.left + 8, height: box.bottom - box.top + 8 })));
  const under = svg("g"), over = svg("g", { "clip-path": `url(#${clip})` });
  picture.append(under, over);
  drawBands(spec, plot, under);
  drawAxes(spec, plot, under);
  drawLines(spec, plot, over);
  drawMarks(spec, plot, under);
  frame.querySelector("svg")?.remove();
  frame.prepend(picture);
  Object.assign(chart, { plot, picture, cursor: null });
  if (chart.at !== null && chart.at !== undefined) readOff(chart, chart.at);
}

// The cursor stands at a point of the first line.
function readOff(chart, index) {
  const { spec, plot, picture } = chart;
  const line = spec.lines[spec.read || 0];
  const xs = xValues(spec, line), at = Math.min(xs.length - 1, Math.max(0, index));
  const x = plot.px(xs[at]);
  chart.at = at;
  chart.cursor?.remove();
  const text = spec.readout(at);
  chart.said.textContent = text;
  chart.frame.setAttribute("aria-valuenow", String(at));
  chart.frame.setAttribute("aria-valuetext", text);
  if (!Number.isFinite(x)) return;
  chart.cursor = svg("g", {}, svg("line", { class: "cursor", x1: x, x2: x, y1: plot.box.top, y2: plot.box.bottom }));
  const y = line.y[at] === null ? NaN : plot.py(line.y[at]);
  if (Number.isFinite(y)) chart.cursor.append(svg("circle", { class: `bead f-${line.colour}`, cx: x, cy: y, r: 4.5 }));
  picture.append(chart.cursor);
}

function nearest(chart, clientX) {
  const { spec, plot, picture } = chart;
  const box = picture.getBoundingClientRect();
  const x = ((clientX - box.left) / box.width) * picture.viewBox.baseVal.width;
  const xs = xValues(spec, spec.lines[spec.read || 0]);
  let best = 0, distance = Infinity;
  for (let i = 0; i < xs.length; i++) {
    const d = Math.abs(plot.px(xs[i]) - x);
    if (d < distance) [best, distance] = [i, d];
  }
  return best;
}

function onKey(chart, event) {
  const last = chart.spec.lines[chart.spec.read || 0].y.length - 1;
  const stride = event.shiftKey ? Math.ceil(last / 10) : Math.ceil(last / 200);
  const now = chart.at ?? 0;
  const moves = { ArrowRight: now + stride, ArrowLeft: now - stride, Home: 0, End: last, PageUp: now + Math.ceil(last / 10),
    PageDown: now - Math.ceil(last / 10) };
  if (!(event.key in moves)) return;
  event.preventDefault();
  readOff(chart, Math.min(last, Math.max(0, moves[event.key])));
}

function legendOf(spec) {
  const named = spec.lines.filter((l) => l.name);
  if (named.length < 2 && !spec.legend) return null;
  const list = element("ul", { class: "legend" });
  for (const line of named) {
    const sample = line.kind === "dots"
      ? svg("circle", { class: line.full ? `dot full f-${line.colour}` : `dot c-${line.colour}`, cx: 11, cy: 5, r: 3.2 })
      : svg("path", { class: `line c-${line.colour}${line.dash ? " dash" : ""}`, d: "M0 5H22" });
    if (line.stroke) sample.style.stroke = line.stroke;
    list.append(element("li", {}, svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" }, sample), line.name));
  }
  for (const [text, inner] of spec.legend || []) {
    const box = svg("rect", { class: inner ? "band inner" : "band", width: 22, height: 10 });
    list.append(element("li", {}, svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" }, box), text));
  }
  return list;
}

// A figure with its chart, its words and its table.
function figure(spec) {
  const last = Math.max(0, spec.lines[spec.read || 0].y.length - 1);
  const frame = element("div", { class: "frame", tabindex: "0", role: "slider", "aria-label": `Read off: ${spec.title}`,
    "aria-valuemin": "0", "aria-valuemax": String(last), "aria-valuenow": "0", "aria-valuetext": "not read yet" });
  const said = element("output");
  if (page.charts.length === 0) said.dataset.hint = "Point at a chart, or focus it and use the arrow keys, to read it off.";
  const whole = element("figure", {}, element("h3", {}, spec.title));
  const legend = legendOf(spec);
  if (legend) whole.append(legend);
  whole.append(frame, said);
  if (spec.caption) whole.append(element("figcaption", {}, spec.caption));
  if (spec.table) whole.append(tableOf(spec.table));
  const chart = { spec, frame, said, at: null, draw: () => draw(chart) };
  frame.addEventListener("pointermove", (event) => readOff(chart, nearest(chart, event.clientX)));
  frame.addEventListener("pointerdown", (event) => readOff(chart, nearest(chart, event.clientX)));
  frame.addEventListener("keydown", (event) => onKey(chart, event));
  page.charts.push(chart);
  whole.chart = chart;
  return whole;
}
