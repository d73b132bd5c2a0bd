// SPDX-License-Identifier: GPL-3.0-or-later
// An interface along a line: what its cells do over place and time at once.
"use strict";

const placeTick = (data) => scaledLengths(data.cells.nx * data.cells.dx);

// Bytes of a field's snapshots by column of the line; 0 where nothing touches.
function columnsOf(cells, maps) {
  return maps.map((map) => {
    const squares = squaresOf(map), row = new Uint16Array(cells.nx);
    cells.place.forEach((column, k) => (row[column] = squares[k]));
    return row;
  });
}

function colourTable(colours) {
  return Array.from({ length: BACKWARDS + 1 }, (_, b) => (b === 0 ? [0, 0, 0, 0] : [...colourOf(colours, b), 255]));
}

// Places of the snapshots on the upright axis, from 0 to 1.
const snapshotPlaces = (cells, y) => (page.axis === "before" ? cells.snapshot_before : cells.snapshot_time).map((t) => y.at(Math.max(t, page.axis === "before" ? y.whole?.low ?? y.low : t)));

// The picture of the part that the plot shows, one colour a pixel.
function strata(cells, rows, colours, plot) {
  const { box, x, y } = plot;
  const width = Math.max(1, Math.round(box.right - box.left)), height = Math.max(1, Math.round(box.bottom - box.top));
  const canvas = element("canvas", { width: String(width), height: String(height) }), context = canvas.getContext("2d");
  const image = context.createImageData(width, height), table = colourTable(colours), places = snapshotPlaces(cells, y);
  const column = Array.from({ length: width }, (_, i) => Math.floor(x.back((i + 0.5) / width) / cells.dx));
  for (let j = 0; j < height; j++) {
    const row = rows[nearestOf(places, 1 - (j + 0.5) / height)];
    for (let i = 0; i < width; i++) image.data.set(table[row[column[i]] ?? 0], 4 * (j * width + i));
  }
  context.putImageData(image, 0, 0);
  return svg("image", { href: canvas.toDataURL(), x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top, preserveAspectRatio: "none" });
}

function upright(data) {
  const { cells } = data, ends = page.axis === "before" ? extentPositive([cells.snapshot_before]) : extent([cells.snapshot_time]);
  return { kind: page.axis === "before" ? "remaining" : "clock", range: ends,
    label: page.axis === "before" ? `Time before ${page.clock.end}` : page.clock.dated ? `Date (${page.clock.zone || FILES_CLOCK})` : `Time since the start (${elapsed(ends, 6).unit})` };
}

const linePlaces = (cells) => Array.from({ length: cells.nx }, (_, i) => (i + 0.5) * cells.dx);

// Place along the line and time up it; the line that is read is that of the slider's snapshot.
function strataFigure(data, kind, state) {
  const { cells } = data, rows = columnsOf(cells, cells[kind.key]), unit = placeTick(data), places = linePlaces(cells);
  const value = (i) => {
    const map = cells[kind.key][state.at], byte = rows[state.at][i];
    if (byte === 0) return "no contact";
    if (byte === BACKWARDS) return "backwards, or at rest";
    return kind.ends ? (byte > 128 ? kind.ends[1] : kind.ends[0]) : kind.words(map.low + ((byte - 1) / 254) * (map.high - map.low));
  };
  const spec = {
    title: `${kind.title} along the line`, height: 420, caption: kind.caption,
    x: { kind: "linear", label: `place along the line (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: [0, cells.nx * cells.dx] },
    get y() { return { fixed: true, ...upright(data) }; },
    lines: [{ kind: "none", colour: "run", x: places, y: places.map(() => null) }],
    image: (plot) => strata(cells, rows, kind.colours, plot),
    get marks() { return [...pointPlaces(data), { y: page.axis === "before" ? Math.max(cells.snapshot_before[state.at], upright(data).range[0]) : cells.snapshot_time[state.at] }]; },
    readout: (i) => `${length(places[i], 4)}, ${moment(page.clock, cells.snapshot_time[state.at])}, ${beforeEnd(page.clock, cells.snapshot_before[state.at])}: ${value(i)}`,
    pick: (where, chart) => {
      const { box, y } = chart.plot;
      state.choose(nearestOf(snapshotPlaces(cells, y), (box.bottom - where[1]) / (box.bottom - box.top)));
      readOff(chart, nearest(chart, where));
    },
  };
  const whole = figure(spec), low = element("span"), high = element("span");
  const { low: least, high: most } = cells[kind.key][0];
  low.textContent = kind.ends ? kind.ends[0] : kind.words(least);
  high.textContent = kind.ends ? kind.ends[1] : kind.words(most);
  whole.querySelector(".frame").after(element("div", { class: "key" }, rampOf(cells, kind), element("div", { class: "ends" }, low, high), ...backOf(cells, kind)));
  return whole;
}

// What does not change: a curve along the line.
function profileFigure(data, kind) {
  const { cells } = data, map = cells[kind.key][0], [row] = columnsOf(cells, [map]), unit = placeTick(data), places = linePlaces(cells);
  const y = Array.from(row, (byte) => (byte === 0 ? null : map.low + ((byte - 1) / 254) * (map.high - map.low)));
  return figure({
    title: `${kind.title} along the line`, caption: kind.caption,
    x: { kind: "linear", label: `place along the line (${unit.unit})`, tick: unit.tick, scale: unit.scale, range: [0, cells.nx * cells.dx] },
    y: { kind: "linear", label: kind.title, tick: (v, more = 0) => kind.words(v, 4 + more) },
    lines: [{ kind: "step", colour: "run", x: places, y }], marks: pointPlaces(data),
    readout: (i) => `${length(places[i], 4)}: ${y[i] === null ? "no contact" : kind.words(y[i], 4)}`,
    table: { n: places.length, caption: kind.title.toLowerCase(), columns: [["Place", (i) => length(places[i], 4)], [kind.title, (i) => (y[i] === null ? "no contact" : kind.words(y[i], 4))]] },
  });
}
