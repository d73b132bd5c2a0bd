// SPDX-License-Identifier: GPL-3.0-or-later
// Where slip goes, of a run that slips in two directions.
"use strict";

const azimuth = (x, y) => (x === null || y === null || (x === 0 && y === 0) ? null : (Math.atan2(y, x) * 180) / Math.PI);

function azimuthChart(s) {
  const now = s.time.map((_, i) => azimuth(s.rate_x[i], s.rate_y[i]));
  const words = (v) => (v === null ? "–" : `${number(v, 4)}°`);
  return figure({
    title: "Direction of slip", caption: "Of the mean slip rate, from x towards y.", x: { clock: true },
    y: { kind: "linear", label: "Direction (degree)", tick: plain(5) },
    lines: [{ kind: "line", colour: "run", time: s.time, before: s.before, y: now }],
    readout: (i) => `${moment(page.clock, s.time[i])}, ${beforeEnd(page.clock, s.before[i])}: ${words(now[i])}`,
    table: { n: s.time.length, caption: "direction of slip", columns: [...clockColumns(s), ["Direction", (i) => words(now[i])]] },
  });
}

function componentsChart(s) {
  const { unit, scale, tick } = scaledLengths(Math.max(...extent([s.x, s.y]).map(Math.abs)));
  return figure({
    title: "Slip along x and y", caption: "Components of the mean slip since the start.", x: { clock: true }, y: { kind: "linear", label: `Slip (${unit})`, scale, tick },
    lines: [{ name: "along x", kind: "line", colour: "run", time: s.time, before: s.before, y: s.x }, { name: "along y", kind: "line", colour: "fast", time: s.time, before: s.before, y: s.y }],
    readout: (i) => `${moment(page.clock, s.time[i])}: ${length(s.x[i])} along x, ${length(s.y[i])} along y`,
    table: { n: s.time.length, caption: "slip along x and y", columns: [...clockColumns(s), ["Along x", (i) => length(s.x[i])], ["Along y", (i) => length(s.y[i])]] },
  });
}

function directionSection(data) {
  const section = openSection("direction", "Direction", "Slip has two directions here: friction opposes it wherever it goes.");
  section.append(element("div", { class: "pair" }, azimuthChart(data.direction), componentsChart(data.direction)));
  return section;
}
