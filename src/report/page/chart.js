// SPDX-License-Identifier: GPL-3.0-or-later
// A chart: lines, dots, bars and bands over a clock or any axis, drawn as SVG.
"use strict";

const page = { data: null, clock: null, axis: "time", charts: [], views: {} };

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

// What the reader made of a chart: enlarged parts of its axes, the other kind of its upright axis, lines left out.
const untouched = () => ({ x: null, y: null, kind: null, hidden: new Set() });

const shown = (chart) => {
  const left = chart.spec.lines.filter((_, i) => !chart.view.hidden.has(i));
  return left.length ? left : chart.spec.lines;
};

// Lines that follow the run do not widen the axis, but those ahead of it do, in time.
const widens = (spec) => (line) => !line.follows || (line.ahead && !turned(spec));

// Dates as far as there are any.
const moments = (range, most) => (page.clock.dated && page.clock.start + range[1] < LAST_DATE ? calendar(range, most, page.clock.start) : elapsed(range, most));

function clockScale(spec, lines, width, ends = null) {
  const lists = [...lines.filter(widens(spec)).map((l) => clockValues(spec, l)), turned(spec) ? [] : spec.x.reach || []];
  if (turned(spec)) return remaining(ends || spec.x.before || extentPositive(lists), width / 74);
  const range = ends || spec.x.range || extent(lists);
  return moments(range, width / 84);
}

// Dots stand clear of the edges.
function widened([low, high], by) {
  const more = (high / low) ** by;
  return low / more > 0 && Number.isFinite(high * more) ? [low / more, high * more] : [low, high];
}

function makeScale(given, lists, most) {
  const axis = typeof given.range === "function" ? { ...given, range: given.range() } : given;
  if (axis.kind === "clock") return moments(axis.range || extent(lists), most);
  if (axis.kind === "remaining") return remaining(axis.range, most);
  if (axis.kind === "spans") return spans(axis.range || extentPositive(lists), most);
  if (axis.kind === "log") return logarithmic(axis.range || widened(extentPositive(lists), axis.clear || 0), most, axis.tick);
  return linear(axis.range || extent(lists), most, axis.tick, axis.scale);
}

function scaleAcross(chart, width) {
  const { spec, view } = chart, lines = shown(chart);
  const make = (range) => (spec.x.clock ? clockScale(spec, lines, width, range)
    : makeScale(range ? { ...spec.x, range } : spec.x, lines.map((l) => l.x), width / 74));
  const whole = make(null);
  return view.x ? enlarged(whole, view.x, make) : whole;
}

// Values of the lines within the enlarged part, and the next ones outside.
function valuesWithin(chart, x) {
  const lists = [];
  for (const line of shown(chart)) {
    const places = xValues(chart.spec, line).map((v) => x.at(v));
    const near = (i) => places[i] >= -0.001 && places[i] <= 1.001;
    for (const list of line.low ? [line.y, line.low, line.high] : [line.y]) lists.push(list.filter((_, i) => near(i) || near(i - 1) || near(i + 1)));
  }
  return lists;
}

const between = ([low, high], lists) => lists.map((list) => list.filter((v) => v >= low && v <= high));

const others = { linear: "log", log: "linear" };

function scaleUp(chart, x, height) {
  const { spec, view } = chart;
  let lists = view.x && !spec.y.fixed ? valuesWithin(chart, x) : shown(chart).flatMap((l) => (l.low ? [l.y, l.low, l.high] : [l.y]));
  if (!view.x) lists.push((spec.marks || []).filter((m) => m.y !== undefined).map((m) => m.y));
  const axis = { ...spec.y };
  if (view.x && axis.kind === "clock") lists = between(axis.range, lists); // the far future would press all else together
  if ((view.x && !axis.fixed) || view.kind) delete axis.range;
  if (view.kind) Object.assign(axis, { kind: view.kind, tick: axis.tick === powerTick ? plain(5) : axis.tick });
  const make = (range) => makeScale(range ? { ...axis, range } : axis, lists, height / 46);
  const whole = make(null);
  return view.y ? enlarged(whole, view.y, make) : whole;
}

function clockLabel(spec, scale) {
  if (turned(spec)) return `time before ${page.clock.end}`;
  if (page.clock.dated && !scale.unit) {
    const [first, last] = [scale.low, scale.high].map((t) => date(page.clock.start + t, "day"));
    return `date (${page.clock.zone || FILES_CLOCK}), ${first === last ? first : `${first} to ${last}`}`;
  }
  return `time since the start (${scale.unit})`;
}

// A path takes no number beyond single precision.
const drawable = (place) => Math.min(1e6, Math.max(-1e6, place));

// Room around the plot, by the longest label.
function layOut(chart, width, height) {
  const y = scaleUp(chart, scaleAcross(chart, width), height);
  const left = 12 + 6.9 * Math.max(...y.ticks.map((t) => String(t.label).length), 2);
  const box = { left, right: width - 14, top: 26, bottom: height - 40 };
  const inner = box.right - box.left;
  const x = scaleAcross(chart, inner);
  return {
    box, x, y,
    px: (v) => drawable(box.left + inner * x.at(v)),
    py: (v) => drawable(box.bottom - (box.bottom - box.top) * y.at(v)),
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

// Between two curves; where the upper one is missing the area is open above.
function areaPath(plot, xs, low, high) {
  const top = plot.box.top - 30, under = plot.box.bottom + 30;
  let path = "", run = [];
  const close = () => {
    if (run.length > 1) path += `M${run.map(([x, , up]) => `${x} ${up}`).join("L")}L${run.reverse().map(([x, down]) => `${x} ${down}`).join("L")}Z`;
    run = [];
  };
  xs.forEach((v, i) => {
    const x = plot.px(v), down = plot.py(low[i]), up = high[i] === null ? top : plot.py(high[i]);
    if (!Number.isFinite(x) || low[i] === null) return close();
    run.push([x.toFixed(1), (Number.isFinite(down) ? Math.min(under, Math.max(top, down)) : under).toFixed(1),
      (Number.isFinite(up) ? Math.min(under, Math.max(top, up)) : under).toFixed(1)]);
  });
  close();
  return path;
}

function drawLines(chart, plot, group) {
  const { spec } = chart;
  for (const line of shown(chart)) {
    const xs = xValues(spec, line);
    if (line.kind === "dots") {
      drawDots(line, plot, xs, group);
    } else if (line.kind === "area") {
      group.append(svg("path", { class: `area f-${line.colour}${line.inner ? " inner" : ""}`, d: areaPath(plot, xs, line.low, line.high) }));
    } else if (line.kind !== "none") {
      const look = `line c-${line.colour}${line.dash ? " dash" : ""}${line.thin ? " thin" : ""}${line.bar ? " bar" : ""}`;
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
      const look = band.level !== undefined ? `level pale l-${band.level}` : band.inner ? "band inner" : "band";
      group.append(svg("rect", { class: look, x: from, width: to - from,
        y: plot.box.top, height: plot.box.bottom - plot.box.top }));
    }
  }
}

// The level as a strip along the upper edge.
function drawLevels(spec, plot, group) {
  for (const band of spec.levels || []) {
    const ends = bandPlaces(spec, plot, band), from = Math.min(...ends), to = Math.max(...ends);
    if (to - from > 0.3) group.append(svg("rect", { class: `level l-${band.level}`, x: from, width: to - from, y: plot.box.top - 8, height: 6 }));
  }
}

function markPlace(spec, plot, mark) {
  return plot.px(spec.x.clock && turned(spec) ? page.clock.last - mark.x : mark.x);
}

// Marks' lines under what is drawn, their labels over it, so that nothing strikes them out.
function drawMarks(spec, plot, group, labels) {
  const { box } = plot;
  let row = 0; // labels of upright marks stand one below the other
  for (const mark of spec.marks || []) {
    const across = mark.y !== undefined;
    const at = across ? plot.py(mark.y) : markPlace(spec, plot, mark);
    if (!Number.isFinite(at) || (!across && (at < box.left - 1 || at > box.right + 1))) continue;
    const ends = across ? { x1: box.left, x2: box.right, y1: at, y2: at } : { x1: at, x2: at, y1: box.top, y2: box.bottom };
    group.append(svg("line", { class: `mark dash${mark.quiet ? " quiet" : ""}${spec.image ? " over" : ""}`, ...ends }));
    if (!mark.label) continue;
    const near = at > (box.left + box.right) / 2;
    const place = across ? { x: box.left + 6, y: at - 5 } : { x: at + (near ? -6 : 6), y: box.top + 11 + 15 * row++, "text-anchor": near ? "end" : "start" };
    labels.append(svg("text", { class: mark.quiet ? "mark-label quiet" : "mark-label", ...place }, mark.label));
  }
}

// A forecast's interval as a bar above the axis: 90 % thin, 50 % thick, its median a stroke.
function drawSpans(spec, plot, group) {
  const { box } = plot;
  const clip = (v, fallback) => Math.min(box.right, Math.max(box.left, Number.isFinite(v) ? v : fallback));
  for (const bar of spec.spans || []) {
    const place = (t) => (t === null ? NaN : markPlace(spec, plot, { x: t }));
    const [low90, low50, middle, high50, high90] = bar.at.map((t, i) => clip(place(t), i < 2 ? box.left : box.right));
    const y = box.bottom - 9;
    if (high90 - low90 < 0.5) continue;
    group.append(svg("line", { class: "c-fit span", x1: low90, x2: high90, y1: y, y2: y }),
      svg("line", { class: "c-fit span thick", x1: low50, x2: high50, y1: y, y2: y }),
      svg("line", { class: "c-fit span middle", x1: middle, x2: middle, y1: y - 6, y2: y + 6 }),
      svg("text", { class: "span-label", x: low90 - 6, y: y + 4, "text-anchor": "end" }, bar.label));
  }
}

let clips = 0;

function draw(chart) {
  const { spec, frame } = chart;
  chart.view = page.views[spec.title] ||= untouched();
  const width = Math.max(240, frame.clientWidth || 640);
  const paper = document.documentElement.classList.contains("paper"); // holds more where charts are lower
  const height = paper ? Math.min(spec.height || Infinity, Math.max(175, Math.round(width * (spec.height ? 0.75 : 0.38))))
    : spec.height || Math.round(Math.min(380, Math.max(230, width * 0.5)));
  const plot = layOut(chart, width, height);
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": spec.title });
  const clip = `clip${++clips}`, { box } = plot;
  picture.append(svg("clipPath", { id: clip }, svg("rect", { x: box.left - 4, y: box.top - 4,
    width: box.right - box.left + 8, height: box.bottom - box.top + 8 })));
  const under = svg("g"), over = svg("g", { "clip-path": `url(#${clip})` });
  picture.append(under, over);
  drawBands(spec, plot, under);
  drawLevels(spec, plot, under);
  drawAxes(spec, plot, under);
  if (spec.image) over.append(spec.image(plot));
  drawLines(chart, plot, over);
  drawMarks(spec, plot, spec.image ? over : under, over);
  drawSpans(spec, plot, over);
  frame.querySelector("svg")?.remove();
  frame.prepend(picture);
  Object.assign(chart, { plot, picture, cursor: null });
  if (chart.at !== null && chart.at !== undefined) readOff(chart, chart.at);
}
