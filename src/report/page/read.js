// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader does with a chart: read it off, enlarge it, turn its axis, leave lines out; by
// pointer, fingers or keys.
"use strict";

const SMALLEST = 2e-4; // part of an axis that can be enlarged

const lineRead = (spec) => spec.lines[spec.read || 0];

// Words of the other lines that have a point near the cursor.
function beside(chart, x) {
  const words = [];
  for (const line of shown(chart).filter((l) => l.words)) {
    const xs = xValues(chart.spec, line);
    let best = -1, distance = 9;
    for (let i = 0; i < xs.length; i++) {
      const d = Math.abs(chart.plot.px(xs[i]) - x);
      if (d < distance && line.y[i] !== null) [best, distance] = [i, d];
    }
    if (best >= 0) words.push(line.words(best));
  }
  return words;
}

// The cursor stands at a point of the line that is read.
function readOff(chart, index) {
  const { spec, plot, picture } = chart;
  const line = lineRead(spec);
  const xs = xValues(spec, line), at = Math.min(xs.length - 1, Math.max(0, index));
  const x = plot.px(xs[at]);
  chart.at = at;
  chart.cursor?.remove();
  const text = [spec.readout(at), ...beside(chart, x)].join("; ");
  chart.said.textContent = text;
  chart.frame.setAttribute("aria-valuenow", String(at));
  chart.frame.setAttribute("aria-valuetext", text);
  if (!Number.isFinite(x) || x < plot.box.left - 1 || x > plot.box.right + 1) return;
  chart.cursor = svg("g", {}, svg("line", { class: "cursor", x1: x, x2: x, y1: plot.box.top, y2: plot.box.bottom }));
  const y = line.y[at] === null ? NaN : plot.py(line.y[at]);
  if (y >= plot.box.top - 1 && y <= plot.box.bottom + 1) chart.cursor.append(svg("circle", { class: `bead f-${line.colour}`, cx: x, cy: y, r: 4.5 }));
  picture.append(chart.cursor);
}

// Where the pointer is, in units of the picture.
function pointed(chart, event) {
  const box = chart.picture.getBoundingClientRect(), scale = chart.picture.viewBox.baseVal.width / box.width;
  return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
}

// The point nearest to a place: along the axis, of dots in both directions.
function nearest(chart, [x, y]) {
  const { spec, plot } = chart, line = lineRead(spec);
  const xs = xValues(spec, line);
  let best = 0, distance = Infinity;
  for (let i = 0; i < xs.length; i++) {
    const d = Math.hypot(plot.px(xs[i]) - x, line.kind === "dots" ? (plot.py(line.y[i]) - y) / 2 : 0);
    if (d < distance) [best, distance] = [i, d];
  }
  return best;
}

const within = (p) => Math.min(1, Math.max(0, p));

// A part of the axis shown, as part of the whole one.
function partOf(old, [from, to]) {
  const [low, high] = old || [0, 1], wide = high - low;
  return [within(low + from * wide), within(low + to * wide)];
}

function sayPart(chart) {
  const { spec, plot, view } = chart;
  if (!view.x) return "The whole axis.";
  const ends = [plot.x.back(0), plot.x.back(1)];
  const words = spec.x.clock ? (turned(spec) ? (v) => span(v, 3) : (v) => moment(page.clock, v)) : spec.x.tick;
  return `Enlarged: ${words(ends[0])} to ${words(ends[1])}${spec.x.clock && turned(spec) ? ` before ${page.clock.end}` : ""}.`;
}

function enlarge(chart, across, up = null) {
  const { view } = chart;
  const x = across && partOf(view.x, across), y = up && partOf(view.y, up);
  if ((x && x[1] - x[0] < SMALLEST) || (y && y[1] - y[0] < SMALLEST)) return;
  if (x) view.x = x[1] - x[0] > 0.999 ? null : x;
  if (y) view.y = y[1] - y[0] > 0.999 ? null : y;
  showView(chart);
}

function showView(chart) {
  chart.tools.whole.disabled = chart.tools.less.disabled = !chart.view.x && !chart.view.y;
  chart.tools.kind?.setAttribute("aria-pressed", String((chart.view.kind || chart.spec.y.kind) === "log"));
  chart.draw();
}

function whole(chart) {
  chart.view.x = chart.view.y = null;
  showView(chart);
}

// By a factor about the cursor, or about the middle.
function enlargeBy(chart, factor) {
  const { plot, spec } = chart, line = lineRead(spec);
  const place = chart.at === null ? NaN : plot.x.at(xValues(spec, line)[chart.at]);
  const about = place >= 0 && place <= 1 ? place : 0.5;
  let from = about - about * factor, to = about + (1 - about) * factor;
  const [low, high] = chart.view.x || [0, 1], wide = high - low; // widened, it stays within the axis
  [from, to] = [Math.max(from, -low / wide), Math.min(to, (1 - low) / wide)];
  enlarge(chart, [from, to], spec.x.clock || chart.view.y === null ? null : factor < 1 ? [0.25, 0.75] : [-0.5, 1.5]);
  chart.said.textContent = sayPart(chart);
}

// The enlarged part goes where the cursor goes.
function follow(chart) {
  const { view, plot, spec } = chart;
  const place = plot.x.at(xValues(spec, lineRead(spec))[chart.at]);
  if (!view.x || !Number.isFinite(place) || (place >= 0 && place <= 1)) return;
  const [low, high] = view.x, wide = high - low, middle = low + place * wide;
  const from = Math.min(1 - wide, Math.max(0, middle - wide / 2));
  view.x = [from, from + wide];
  chart.draw();
}

function turnKind(chart) {
  const { view, spec } = chart;
  view.kind = view.kind ? null : others[spec.y.kind];
  view.y = null;
  showView(chart);
}

function onKey(chart, event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const acts = { "+": () => enlargeBy(chart, 0.5), "=": () => enlargeBy(chart, 0.5), "-": () => enlargeBy(chart, 2),
    0: () => whole(chart), Escape: () => whole(chart), l: () => chart.tools.kind && turnKind(chart) };
  const last = lineRead(chart.spec).y.length - 1;
  const part = chart.view.x ? chart.view.x[1] - chart.view.x[0] : 1;
  const stride = Math.max(1, Math.ceil((part * last) / (event.shiftKey ? 10 : 200)));
  const now = chart.at ?? 0, page10 = Math.ceil((part * last) / 10);
  const moves = { ArrowRight: now + stride, ArrowUp: now + stride, ArrowLeft: now - stride, ArrowDown: now - stride, Home: 0, End: last,
    PageUp: now + page10, PageDown: now - page10 };
  if (!(event.key in moves) && !(event.key in acts)) return;
  event.preventDefault();
  if (event.key in acts) return acts[event.key]();
  readOff(chart, Math.min(last, Math.max(0, moves[event.key])));
  follow(chart);
}

// Drawing a mouse over the chart enlarges what it went over: on a clock the time, else both axes.
function dragging(chart) {
  let from = null, box = null;
  const ends = (event) => {
    const { plot } = chart, [x, y] = pointed(chart, event);
    const clip = (v, low, high) => Math.min(high, Math.max(low, v));
    return [clip(x, plot.box.left, plot.box.right), clip(y, plot.box.top, plot.box.bottom)];
  };
  const shape = (to) => {
    const { plot, spec } = chart, tall = !spec.x.clock;
    return { x: Math.min(from[0], to[0]), width: Math.abs(to[0] - from[0]), y: tall ? Math.min(from[1], to[1]) : plot.box.top,
      height: tall ? Math.abs(to[1] - from[1]) : plot.box.bottom - plot.box.top };
  };
  const end = () => {
    box?.remove();
    from = box = null;
  };
  chart.frame.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "touch" || event.button !== 0) return;
    from = ends(event);
    chart.frame.setPointerCapture(event.pointerId);
  });
  chart.frame.addEventListener("pointermove", (event) => {
    if (!from) return;
    const s = shape(ends(event));
    if (!box && s.width < 8) return;
    if (!box) chart.picture.append((box = svg("rect", { class: "picked" })));
    for (const [key, value] of Object.entries(s)) box.setAttribute(key, value);
  });
  chart.frame.addEventListener("pointerup", (event) => {
    if (!from) return;
    const s = shape(ends(event)), { plot } = chart, wide = plot.box.right - plot.box.left, tall = plot.box.bottom - plot.box.top;
    const across = [(s.x - plot.box.left) / wide, (s.x + s.width - plot.box.left) / wide];
    const up = [(plot.box.bottom - s.y - s.height) / tall, (plot.box.bottom - s.y) / tall];
    end();
    if (s.width >= 8) enlarge(chart, across, !chart.spec.x.clock && s.height >= 8 ? up : null);
  });
  chart.frame.addEventListener("pointercancel", end);
  chart.frame.addEventListener("dblclick", () => whole(chart));
}

// Buttons over a chart; its keys do the same, so that the Tab key passes them by.
function toolsOf(chart) {
  const button = (label, name, act) => {
    const one = element("button", { type: "button", class: "tool", tabindex: "-1", "aria-label": `${name}: ${chart.spec.title}`, title: name }, label);
    one.addEventListener("click", act);
    return one;
  };
  const { spec } = chart, bar = element("div", { class: "tools" });
  const positive = spec.lines.some((l) => l.y.some((v) => v > 0));
  if (others[spec.y.kind] && !spec.y.fixed && positive) {
    chart.tools.kind = button("log", "Logarithmic axis (L)", () => turnKind(chart));
    chart.tools.kind.setAttribute("aria-pressed", String((chart.view.kind || spec.y.kind) === "log"));
    bar.append(chart.tools.kind);
  }
  chart.tools.more = button("+", "Enlarge (+)", () => enlargeBy(chart, 0.5));
  chart.tools.less = button("−", "Show more (−)", () => enlargeBy(chart, 2));
  chart.tools.whole = button("whole", "Show all (0)", () => whole(chart));
  bar.append(chart.tools.more, chart.tools.less, chart.tools.whole);
  return bar;
}

function sampleOf(line) {
  const sample = line.kind === "dots" ? svg("circle", { class: line.full ? `dot full f-${line.colour}` : `dot c-${line.colour}`, cx: 11, cy: 5, r: 3.2 })
    : line.kind === "area" ? svg("rect", { class: `area f-${line.colour}${line.inner ? " inner" : ""}`, width: 22, height: 10 })
      : svg("path", { class: `line c-${line.colour}${line.dash ? " dash" : ""}`, d: "M0 5H22" });
  if (line.stroke) sample.style.stroke = line.stroke;
  return svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" }, sample);
}

// Each line's name is a switch.
function legendOf(chart) {
  const { spec } = chart, named = spec.lines.filter((l) => l.name), extra = (spec.legend || []).filter(Boolean);
  if (named.length < 2 && !extra.length) return null;
  const list = element("ul", { class: "legend" });
  for (const line of named) {
    const index = spec.lines.indexOf(line), one = element("button", { type: "button", "aria-pressed": String(!chart.view.hidden.has(index)), title: "Show or leave out" }, sampleOf(line), line.name);
    one.addEventListener("click", () => {
      const { hidden } = chart.view;
      if (!hidden.delete(index)) hidden.add(index);
      one.setAttribute("aria-pressed", String(!hidden.has(index)));
      chart.draw();
    });
    list.append(element("li", {}, one));
  }
  for (const [text, look] of extra) {
    const box = svg("rect", { class: look, width: 22, height: 10 });
    list.append(element("li", {}, svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" }, box), text));
  }
  return list;
}

// A figure with its chart, its words and its table.
function figure(spec) {
  const last = Math.max(0, lineRead(spec).y.length - 1);
  const frame = element("div", { class: "frame", tabindex: "0", role: "slider", "aria-label": `Read off: ${spec.title}`,
    "aria-valuemin": "0", "aria-valuemax": String(last), "aria-valuenow": "0", "aria-valuetext": "not read yet", "aria-keyshortcuts": "+ - 0 L" });
  const said = element("output");
  if (page.charts.length === 0) said.dataset.hint = "Point at a chart, or reach it with Tab and use the arrow keys, to read it off; draw over it, or press + and −, to enlarge it, 0 for all of it.";
  const chart = { spec, frame, said, at: null, view: (page.views[spec.title] ||= untouched()), tools: {}, draw: () => draw(chart) };
  const outer = element("figure", {}, element("div", { class: "head" }, element("h3", {}, spec.title), toolsOf(chart)));
  const legend = legendOf(chart);
  if (legend) outer.append(legend);
  outer.append(frame, said);
  if (spec.caption) outer.append(element("figcaption", {}, spec.caption));
  if (spec.table) outer.append(tableOf(spec.table));
  const point = (event) => (spec.pick || ((where) => readOff(chart, nearest(chart, where))))(pointed(chart, event), chart);
  frame.addEventListener("pointermove", point);
  frame.addEventListener("pointerdown", point);
  frame.addEventListener("keydown", (event) => onKey(chart, event));
  dragging(chart);
  chart.tools.whole.disabled = chart.tools.less.disabled = !chart.view.x && !chart.view.y;
  page.charts.push(chart);
  outer.chart = chart;
  return outer;
}
