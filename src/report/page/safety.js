// SPDX-License-Identifier: GPL-3.0-or-later
// What an engineer looks at below the motion: the factor of safety; water, and what brings it.
"use strict";

const millimetresADay = (v) => v * DAY * 1e3;

// Whether a column changes by more than its digits are worth: what stays is told by the case.
function isChanging(column) {
  const [low, high] = extent([column || [0]]);
  return high - low > 1e-5 * Math.abs(high);
}

// One column over time. `words` says a value, `tick` one on the axis.
function safetyChart(s, key, { title, name, caption, label, words, tick, scale, kind = "line", marks = [] }) {
  return figure({
    title, caption, x: { clock: true }, y: { kind: "linear", label, tick, ...(scale && { scale }) }, marks,
    lines: [{ kind, colour: "run", time: s.time, before: s.before, y: s[key] }],
    readout: (i) => `${moment(page.clock, s.time[i])}, ${beforeEnd(page.clock, s.before[i])}: ${s[key][i] === null ? "–" : words(s[key][i])}`,
    table: { n: s.time.length, caption: title.toLowerCase(), columns: [...clockColumns(s), [name || title, (i) => (s[key][i] === null ? "–" : words(s[key][i]))]] },
  });
}

function factorChart(data) {
  const named = data.about.factor_of_safety_reference_rate_m_s;
  const at = named === undefined ? "the reference rate v₀ of the friction" : rate(named);
  return safetyChart(data.safety, "factor", {
    title: "Factor of safety", label: "Strength over load", tick: plain(5), words: plain(5), marks: [{ y: 1 }],
    caption: `What friction would hold if all cells slid at ${at} in their present states, over the shear force that drives. Above 1 the joint is slower than that, below 1 faster.`,
  });
}

function pressureChart(s, key, title, caption) {
  const most = Math.max(...extent([s[key]]).map(Math.abs));
  const [unit, scale] = PRESSURES.find(([, size]) => most >= size) || PRESSURES[PRESSURES.length - 1];
  return safetyChart(s, key, { title, caption,
    label: `${title} (${unit})`, scale, tick: (v, more = 0) => number(v / scale, 5 + more), words: (v) => pressure(v, 5) });
}

function levelOfLake(s, key, title) {
  return safetyChart(s, key, { title, caption: "As the load reads it, on the scale of its elevation.", label: "Level (m)",
    tick: plain(6), words: (v) => `${number(v, 6)}${THIN}m` });
}

// What fell over a span stands from its beginning to the next.
function rainChart(s, key, title) {
  return safetyChart(s, key, { title, caption: "What the load reads, over the time in which it fell.", label: "Rain (mm/day)", kind: "step",
    scale: 1e-3 / DAY, tick: (v, more = 0) => number(millimetresADay(v), 4 + more), words: (v) => `${number(millimetresADay(v), 4)}${THIN}mm/day` });
}

// Of a base that bends.
function baseCharts(s) {
  const row = element("div", { class: "pair" });
  if (isChanging(s.angle)) row.append(safetyChart(s, "angle", { title: "Dip of the base", caption: "At the mean slip: what pulls and presses goes with it.", label: "Dip (degree)", tick: plain(5), words: (v) => `${number(v, 5)}°` }));
  if (isChanging(s.thickness)) row.append(safetyChart(s, "thickness", { title: "Thickness", caption: "Of the sliding mass, measured vertically, at the mean slip.", label: "Thickness (m)", tick: plain(5), words: (v) => `${number(v, 5)}${THIN}m` }));
  return row;
}

const kelvins = (v) => `${number(v, 4)}${THIN}K`;

// What weakens the cells besides friction.
function weakeningCharts(s) {
  const row = element("div", { class: "pair" });
  if (isChanging(s.excess)) row.append(pressureChart(s, "excess", "Excess pore pressure", "What slip made of it, in excess of that of the loads; mean over the cells by the normal force that each carries."));
  if (isChanging(s.heat)) row.append(safetyChart(s, "heat", { title: "Temperature", caption: "Largest rise of any cell, in the middle of the sheared layer.", label: "Rise (K)", tick: plain(4), words: kelvins }));
  if (isChanging(s.broken)) row.append(safetyChart(s, "broken", { title: "Broken cohesion", caption: "Part of the bridges of rock that is broken; mean over the cells.", label: "Part", tick: plain(4), words: plain(4) }));
  return row;
}

function safetySection(data) {
  const s = data.safety, wet = Boolean(isChanging(s.pore) || s.lake || s.rain);
  const section = openSection("safety", !s.factor ? "Water" : wet ? "Safety and water" : "Safety",
    wet ? "How far the load is from the strength, and the water that takes strength away." : "How far the load is from the strength.");
  const row = element("div", { class: "pair" });
  if (s.factor) section.append(factorChart(data));
  if (isChanging(s.ratio)) row.append(safetyChart(s, "ratio", { title: "Effective ratio", caption: "Shear force over the normal force that pore pressure leaves.", label: "Q/(P − U)", tick: plain(5), words: plain(5) }));
  if (isChanging(s.pore)) row.append(pressureChart(s, "pore", "Pore pressure", "In the interface; of all cells, or their mean by the normal force that each carries."));
  if (row.children.length) section.append(row);
  for (const more of [baseCharts(s), weakeningCharts(s)]) if (more.children.length) section.append(more);
  if (s.lake) section.append(levelOfLake(s, "lake", "Lake level"));
  if (s.lake2) section.append(levelOfLake(s, "lake2", "Lake level, second load"));
  if (isChanging(s.table)) section.append(levelOfLake(s, "table", "Water level"));
  if (s.rain) section.append(rainChart(s, "rain", "Rain"));
  if (s.rain2) section.append(rainChart(s, "rain2", "Rain, second load"));
  return section;
}
