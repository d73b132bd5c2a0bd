// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of the contact domain, and the slider through its snapshots.
"use strict";

// Viridis-like, so that order shows in grey and to all eyes; light end last.
const RAMP = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
const STICK = [128, 139, 152], SLIP = [214, 106, 20], BACK = [224, 40, 122], BACKWARDS = 256;

function mix(colours, place) {
  const at = Math.min(0.9999, Math.max(0, place)) * (colours.length - 1), k = Math.floor(at), t = at - k;
  return colours[k].map((c, i) => Math.round(c + t * (colours[k + 1][i] - c)));
}

const gradient = (colours, turn = "") => `linear-gradient(90deg, ${colours.map((c) => `rgb(${c.join(",")})${turn}`).join(",")})`;

// The key of a map's colours. Of what is one or the other none between, where a square is one cell.
function rampOf(cells, kind) {
  const ramp = element("div", { class: "ramp" }), either = kind.ends && cells.block === 1;
  const [first, last] = [kind.colours[0], kind.colours[kind.colours.length - 1]];
  ramp.style.background = either ? gradient([first, last], " 50%") : gradient(kind.colours);
  return ramp;
}

function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

// What the squares of a map show: 0 nothing, 1 to 255 its range, BACKWARDS what has no place in it.
function squaresOf(map) {
  const squares = Uint16Array.from(bytesOf(map.map));
  if (map.backwards) bytesOf(map.backwards).forEach((b, k) => b && (squares[k] = BACKWARDS));
  return squares;
}

const colourOf = (colours, b) => (b === BACKWARDS ? BACK : mix(colours, (b - 1) / 254));

// The key of squares that have no place in the range; none where no map has one.
function backOf(cells, kind) {
  if (!cells[kind.key].some((map) => map.backwards)) return [];
  const square = element("i");
  square.style.background = `rgb(${BACK.join(",")})`;
  return [element("p", { class: "back" }, square, "slips backwards, or stands")];
}

// Paints the squares; y runs up, as on a map.
function paint(canvas, cells, bytes, colours) {
  const { nx, ny, place } = cells, context = canvas.getContext("2d");
  const image = context.createImageData(nx, ny);
  for (let k = 0; k < place.length; k++) {
    if (bytes[k] === 0) continue;
    const row = ny - 1 - Math.floor(place[k] / nx), at = 4 * (row * nx + (place[k] % nx));
    const [r, g, b] = colourOf(colours, bytes[k]);
    image.data.set([r, g, b, 255], at);
  }
  context.putImageData(image, 0, 0);
}

function slider({ name, id, n, at, times, words, change }) {
  const input = element("input", { type: "range", id, min: "0", max: String(n - 1), step: "1", value: String(at), "aria-label": name });
  input.times = times; // a page that goes on finds its place again by them
  const now = element("output", { class: "now", for: id });
  const say = () => {
    now.textContent = `${name}: ${words(Number(input.value))}`;
    input.setAttribute("aria-valuetext", words(Number(input.value)));
  };
  input.addEventListener("input", () => {
    say();
    change(Number(input.value));
  });
  const play = element("button", { type: "button" }, "Play");
  playing(play, input, n);
  say();
  return element("div", { class: "slider" }, play, input, now);
}

function playing(button, input, n) {
  let timer = null;
  const stop = () => {
    clearInterval(timer);
    timer = null;
    button.textContent = "Play";
    delete button.dataset.playing;
  };
  button.addEventListener("click", () => {
    if (timer !== null) return stop();
    button.textContent = "Stop";
    button.dataset.playing = "yes";
    if (Number(input.value) >= n - 1) input.value = "0";
    timer = setInterval(() => {
      input.value = String(Number(input.value) + 1);
      input.dispatchEvent(new Event("input"));
      if (Number(input.value) >= n - 1) stop();
    }, 260);
  });
}

// The maps a run can show: key, title, colours, words of a value, what stands under it.
function mapKinds(cells) {
  const kinds = [];
  const state = [STICK, SLIP];
  if (cells.slipping && cells.slipping_rate !== null) {
    kinds.push({ key: "slipping", title: "Stick and slip", colours: state, ends: ["sticks", "slips"],
      caption: `A cell slips where it is faster than ${rate(cells.slipping_rate)}, ten times the mean at the start.` });
  }
  if (cells.rate) kinds.push({ key: "rate", title: "Slip rate", colours: RAMP, words: (v) => rate(10 ** v), caption: "Logarithmic, one range for all times; of squares of several cells their fastest." });
  if (cells.slip) kinds.push({ key: "slip", title: "Slip", colours: RAMP, words: (v) => length(v), caption: cells.ny === 1 ? "Since the start." : "Since the start, each time in its own range." });
  if (cells.traction) kinds.push({ key: "traction", title: "Shear traction", colours: RAMP, words: (v) => pressure(v), caption: "The elastic side of the balance, q − Kδ, one range for all times." });
  if (cells.safety) kinds.push({ key: "safety", title: "Factor of safety", colours: RAMP, words: (v) => number(10 ** v, 3), caption: "Strength of each cell at the reference rate over the traction that it carries; logarithmic, one range for all times." });
  if (cells.pore) kinds.push({ key: "pore", title: "Pore pressure", colours: RAMP, words: (v) => pressure(v), caption: "Over the nominal area, one range for all times." });
  if (cells.excess) kinds.push({ key: "excess", title: "Excess pore pressure", colours: RAMP, words: (v) => pressure(v), caption: "What slip made of it, in excess of that of the loads; one range for all times." });
  if (cells.heat) kinds.push({ key: "heat", title: "Temperature", colours: RAMP, words: kelvins, caption: "Its rise in the middle of the sheared layer, one range for all times." });
  if (cells.broken) kinds.push({ key: "broken", title: "Broken cohesion", colours: RAMP, words: plain(3), caption: "Part of the cohesion of each cell that is broken, one range for all times." });
  if (cells.pressure) kinds.push({ key: "pressure", title: "Normal pressure", colours: RAMP, words: (v, digits) => pressure(v, digits), still: true, caption: "Of the contact, before pore pressure." });
  return kinds;
}

// A scale bar of a round length, at most a third of the width.
function scaleBar(wide, oblique) {
  const size = [5, 2, 1].map((m) => m * 10 ** Math.floor(Math.log10(wide / 3))).find((v) => v <= wide / 3);
  const bar = element("span", { class: "bar" });
  bar.style.width = `${(100 * size) / wide}%`;
  return [bar, element("span", {}, `${length(size)}${oblique ? " along x" : ""}`)];
}

// Numbers along a side of a map; those at its ends stand within it. A low side has room for its ends, or one of them.
function ticksOf(side, long, unit, room) {
  const low = room < 0.3 ? [...(room > 0.15 ? [0] : []), long].map((value) => ({ value, label: unit.tick(value) })) : null;
  return (low || linear([0, long], 4, unit.tick, unit.scale).ticks).map(({ value, label }) => {
    const place = value / long, mark = element("span", { class: place > 0.95 ? "last" : place < 0.05 ? "first" : "" }, label);
    mark.style[side] = `${100 * place}%`;
    return mark;
  });
}

// A map with its axes, a scale bar and the points. A strip narrower than a twelfth of its length is drawn wider than it is.
function planOf(data, canvas) {
  const { cells } = data, wide = cells.nx * cells.dx, high = cells.ny * cells.dy, unit = scaledLengths(Math.max(wide, high));
  const oblique = high < wide / 12, tall = oblique ? 1 / 12 : high / wide;
  canvas.style.aspectRatio = String(1 / tall);
  return element("div", { class: "plan" }, element("div", { class: "up" }, ...ticksOf("bottom", high, unit, tall)),
    element("div", { class: "field" }, canvas, ...pointMarks(data, wide, high)), element("div", { class: "across" }, ...ticksOf("left", wide, unit, 1)),
    element("div", { class: "under" }, ...scaleBar(wide, oblique), element("span", { class: "axes" }, `x, y in ${unit.unit}`)));
}

function mapFigure(data, kind) {
  const { cells } = data;
  const canvas = element("canvas", { class: "map", width: String(cells.nx), height: String(cells.ny), role: "img" });
  const low = element("span"), high = element("span");
  const show = (k) => {
    const map = cells[kind.key][kind.still ? 0 : k];
    paint(canvas, cells, squaresOf(map), kind.colours);
    low.textContent = kind.ends ? kind.ends[0] : kind.words(map.low);
    high.textContent = kind.ends ? kind.ends[1] : kind.words(map.high);
    canvas.setAttribute("aria-label", `${kind.title}, from ${low.textContent} to ${high.textContent}${map.backwards ? ", some backwards" : ""}`);
  };
  const whole = element("figure", {}, element("h3", {}, kind.title), planOf(data, canvas), rampOf(cells, kind), element("div", { class: "ends" }, low, high), ...backOf(cells, kind), element("figcaption", {}, kind.caption));
  return { whole, show };
}

function snapshotTable(cells) {
  const columns = [["Time", (i) => moment(page.clock, cells.snapshot_time[i])], [`Before ${page.clock.end}`, (i) => span(cells.snapshot_before[i])]];
  if (cells.slipping) columns.push(["Slipping cells", (i) => count(cells.slipping_cells[i])], ["of", () => count(cells.cells)]);
  if (cells.rate) columns.push(["Slowest square", (i) => squareEnd(cells.rate[i], 0)], ["Fastest", (i) => squareEnd(cells.rate[i], 1)]);
  if (cells.slip) columns.push(["Least slip", (i) => length(cells.slip[i].low)], ["Most slip", (i) => length(cells.slip[i].high)]);
  return tableOf({ n: cells.snapshot_time.length, caption: "snapshots of the contact domain", columns });
}

// The least or greatest rate of a map, from its bytes.
function squareEnd(map, greatest) {
  const seen = bytesOf(map.map).filter((b) => b > 0);
  const byte = seen.reduce((a, b) => (greatest ? Math.max(a, b) : Math.min(a, b)), seen[0] ?? 1);
  return rate(10 ** (map.low + ((byte - 1) / 254) * (map.high - map.low)));
}

// Where about half of what will ever slip does; three quarters on where all do at once: a time that shows something.
function firstSnapshot(cells) {
  const n = cells.snapshot_time.length, slips = cells.slipping_cells || [];
  const most = Math.max(...slips), half = (most + Math.min(...slips)) / 2;
  const best = slips.reduce((at, v, k) => (Math.abs(v - half) < Math.abs(slips[at] - half) ? k : at), 0);
  return Math.abs(slips[best] - half) < (most - half) / 2 ? best : Math.floor((n - 1) * 0.75);
}

function snapshotSlider(cells, at, change) {
  return slider({ name: "Time", id: "snapshot", n: cells.snapshot_time.length, at, times: cells.snapshot_time, change,
    words: (k) => `${moment(page.clock, cells.snapshot_time[k])}, ${beforeEnd(page.clock, cells.snapshot_before[k])}` +
      (cells.slipping ? `, ${many(cells.slipping_cells[k], "cell")} ${cells.slipping_cells[k] === 1 ? "slips" : "slip"}` : "") });
}

function squaresBody(data, kinds, moving) {
  const { cells } = data, maps = kinds.map((kind) => mapFigure(data, kind)), at = moving ? firstSnapshot(cells) : 0;
  maps.forEach((m) => m.show(at));
  const control = moving ? [snapshotSlider(cells, at, (k) => maps.forEach((m) => m.show(k)))] : [];
  return [...control, element("div", { class: "maps" }, ...maps.map((m) => m.whole))];
}

// Maps over place and time; the slider's time is marked in them all.
function lineBody(data, kinds, moving) {
  const { cells } = data, state = { at: moving ? firstSnapshot(cells) : 0 };
  const figures = kinds.map((kind) => (kind.still ? profileFigure(data, kind) : strataFigure(data, kind, state)));
  const control = moving ? snapshotSlider(cells, state.at, (k) => {
    state.at = k;
    figures.filter((f) => f.chart.spec.image).forEach((f) => f.chart.draw());
  }) : null;
  state.choose = (k) => {
    if (k === state.at) return;
    const input = control.querySelector("input");
    input.value = String(k);
    input.dispatchEvent(new Event("input"));
  };
  return [...(control ? [control] : []), element("div", { class: "pair" }, ...figures)];
}

function cellsSection(data) {
  const { cells } = data, line = cells.ny === 1;
  const moving = cells.snapshot_time.length > 0 && Boolean(cells.rate || cells.slip || cells.traction || cells.safety);
  const kinds = mapKinds(cells);
  const squares = cells.block > 1 ? ` Each square stands for ${line ? cells.block : `${cells.block} × ${cells.block}`} cells of the grid.` : "";
  const where = line ? `along ${length(cells.nx * cells.dx)}` : `${length(cells.nx * cells.dx)} by ${length(cells.ny * cells.dy)}${data.direction ? "" : "; slip is along x, to the right"}`;
  const section = openSection("cells", "Contact domain", `${many(cells.cells, "cell")} ${cells.cells === 1 ? "touches" : "touch"}, ${where}. Empty places do not touch.${squares}`);
  section.append(...(line ? lineBody(data, kinds, moving) : squaresBody(data, kinds, moving)));
  if (moving) section.append(snapshotTable(cells));
  return section;
}
