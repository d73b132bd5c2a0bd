// SPDX-License-Identifier: GPL-3.0-or-later
// An ensemble: how likely it fails and when, the fan of its members, what decides, and its members one by one.
"use strict";

const MOST_SIDES = 6; // of the matrix of scatter

const percents = (share, digits = 3) => (share === null ? "–" : `${number(100 * share, digits)}${THIN}%`);
const isTime = (answers) => answers.result === "failure_time";
const resultName = (answers) => (isTime(answers) ? "time of failure" : answers.result.replace(/_/g, " "));
const ofResult = (answers, value, never) => (never ? "never" : quantity(value, answers.unit));

// The last parts of keys that tell them apart.
function shortNames(keys) {
  const tail = (key, parts) => key.split(".").slice(-parts).join(" ").replace(/_/g, " ");
  return keys.map((key) => [1, 2, 3, 4].map((parts) => tail(key, parts)).find((name, i) => keys.filter((k) => tail(k, i + 1) === name).length === 1) || key);
}

function ensembleVerdict({ sweep: { answers: a } }) {
  const left = a.broken ? ` ${many(a.broken, "member")} of ${count(a.members)} broke, and ${a.broken === 1 ? "is" : "are"} left out.` : "";
  const p = a.probability;
  if (!p) return `${many(a.members, "member")}, one parameter changed at a time.${left}`;
  if (p.share === null) return `No member tells ${isTime(a) ? "whether it fails" : `its ${resultName(a)}`}.${left}`;
  const first = a.influences.find((i) => i.first !== null);
  const why = first ? ` What decides most: ${shortNames(a.influences.map((i) => i.parameter))[a.influences.indexOf(first)]}.` : "";
  const middle = a.quantiles.find((q) => q.share === 0.5);
  if (!isTime(a)) return `Of ${many(a.counted, "member")} half have a ${resultName(a)} below ${quantity(middle.value, a.unit)} (${a.about}).${why}${left}`;
  return `It fails within ${span(p.by)} in ${percents(p.share)} (${percents(p.low)} to ${percents(p.high)}) of ${many(p.known + p.unknown, "member")}.${why}${left}`;
}

function ensembleFacts({ sweep: { answers: a } }) {
  const list = [["Members", count(a.members), a.broken ? `${count(a.broken)} broken` : "none broken"],
    isTime(a) ? ["Never fail", count(a.never), "within their time"] : ["Without it", count(a.missing), resultName(a)]];
  const middle = a.quantiles.find((q) => q.share === 0.5);
  if (middle) list.push([isTime(a) ? "Half fail within" : "Half are below", ofResult(a, middle.value, middle.never), ""]);
  return list;
}

function likelyChart(data) {
  const a = data.sweep.answers, of = isTime(a), at = (v) => (of ? moment(page.clock, v) : quantity(v, a.unit)), said = of ? "have failed" : "are at most that", list = a.probability_over_time, y = list.map((p) => p.share), time = list.map((p) => p.by);
  return figure({
    title: of ? "Probability of failure" : `Distribution of ${resultName(a)}`, x: of ? { clock: true, axis: "time" } : { kind: "linear", label: `${resultName(a)} (${a.unit})`, tick: plain(3) },
    y: { kind: "linear", label: `Share of members that ${said}`, tick: (v) => percents(v), range: [0, 1], fixed: true },
    lines: [{ name: "95 % interval", kind: "area", colour: "run", time, y, low: list.map((p) => p.low), high: list.map((p) => p.high) },
      { name: "share", kind: "step", colour: "run", time, y }].map((line) => (of ? line : { ...line, x: time, time: undefined })),
    read: 1, caption: "Band: 95 % interval (Wilson) of a share of as many members.",
    readout: (i) => `${at(time[i])}: ${percents(y[i])} (${percents(list[i].low)} to ${percents(list[i].high)}) ${said}`,
    table: { n: list.length, caption: "share of members", columns: [[of ? "By" : "At most", (i) => at(time[i])], ["Share", (i) => percents(y[i])],
      ["95 % interval", (i) => `${percents(list[i].low)} to ${percents(list[i].high)}`]] },
  });
}

function quantileTable(answers) {
  const q = answers.quantiles, end = (value, never) => (value === null && !never ? "too few members" : ofResult(answers, value, never));
  return element("div", { class: "plain" }, bareTable(isTime(answers) ? "When it fails" : `Quantiles of ${resultName(answers)}`, q.length, [["Share of members", (i) => percents(q[i].share)],
    [isTime(answers) ? "Fails within" : "Is below", (i) => ofResult(answers, q[i].value, q[i].never)], ["95 % interval", (i) => `${end(q[i].low)} to ${end(q[i].high, q[i].high_never)}`]]));
}

function likelySection(data) {
  const { answers } = data.sweep, lost = answers.probability.unknown;
  const section = openSection("likely", isTime(answers) ? "How likely it fails, and when" : `How much: ${answers.about}`, `Of ${many(answers.counted, "member")} as they were drawn.${lost ? ` ${many(lost, "member")} ended before ${span(answers.probability.by)} without failure: the interval holds both of what they may do.` : ""}`);
  section.append(likelyChart(data), quantileTable(answers));
  return section;
}

// Rows of a chart with a name each, the first on top. @param lines  of places [[x of a row, ...], ...] already at y
function barChart({ title, caption, names, label, x, lines, marks, readout, table }) {
  const n = names.length, at = names.map((_, k) => n - 1 - k);
  return figure({
    title, caption, marks, height: 46 * (n + 1) + 30, x: { kind: "linear", label, ...x },
    y: { kind: "linear", label: "", tick: (v) => (Number.isInteger(v) ? names[n - 1 - v] ?? "" : ""), range: [-0.6, n - 0.4], fixed: true },
    lines: [{ kind: "none", colour: "run", x: at.map((_, k) => lines[0].ends[k]), y: at }, ...lines.map((line) => ({ ...line, kind: "line", y: at.flatMap((k) => [k + (line.up || 0), k + (line.up || 0), null]),
      x: line.from.flatMap((v, k) => [v, line.ends[k], null]) }))],
    readout, table,
  });
}

// Bars from what the base does to what a parameter does low and high; to the edge where that is never.
function swingChart({ answers: a }) {
  const known = a.swings.filter((s) => s.result_low !== null || s.result_high !== null || s.low_never || s.high_never), names = shortNames(known.map((s) => s.parameter));
  const [least, most] = extent([known.flatMap((s) => [s.result_low, s.result_high]), [a.base]]), wide = most - least || most || 1, never = most + 0.15 * wide;
  const place = (value, forever) => (forever ? never : value), start = place(a.base, a.base_never), from = known.map(() => start);
  const value = (s, key) => `${s[`${key}_word`] ?? quantity(s[key], s.unit)}: ${ofResult(a, s[`result_${key}`], s[`${key}_never`])}`;
  const [unit, scale] = isTime(a) ? SPANS.find(([, s]) => most / s >= 1) || ["s", 1] : [a.unit, 1];
  return barChart({
    title: "One at a time", names, label: `${resultName(a)} (${unit})${isTime(a) ? "; at the right edge: never" : ""}`, caption: `Each parameter alone low and high, the others as in the base, which ${isTime(a) ? "fails after" : "comes to"} ${ofResult(a, a.base, a.base_never)}.`,
    x: { range: [least - 0.05 * wide, never], tick: (v, more = 0) => number(v / scale, 4 + more), scale }, marks: start === null ? [] : [{ x: start, label: "as it stands" }],
    lines: [{ name: "low", colour: "run", bar: true, up: 0.13, from, ends: known.map((s) => place(s.result_low, s.low_never)) }, { name: "high", colour: "fast", bar: true, up: -0.13, from, ends: known.map((s) => place(s.result_high, s.high_never)) }],
    readout: (i) => `${names[i]}: ${value(known[i], "low")}; ${value(known[i], "high")}`,
    table: { n: known.length, caption: "one at a time", columns: [["Parameter", (i) => known[i].parameter], ["Low", (i) => value(known[i], "low")], ["High", (i) => value(known[i], "high")]] },
  });
}

function influenceChart({ answers: a }) {
  const list = a.influences, names = shortNames(list.map((i) => i.parameter)), totals = list.some((i) => i.total !== null), zero = list.map(() => 0);
  const bar = (key, name, colour, up) => [{ name, colour, up, bar: true, from: zero, ends: list.map((i) => i[key]) },
    { colour, up, thin: true, stroke: "var(--ink)", from: list.map((i) => i[`${key}_low`]), ends: list.map((i) => i[`${key}_high`]) }];
  const told = (one, key) => (one[key] === null ? "–" : `${number(one[key], 2)} ± ${number(one[`${key}_error`], 2)}`);
  return barChart({
    title: "What decides", names, label: "part of the variance", x: { tick: plain(3), range: [Math.min(0, extent([list.flatMap((i) => [i.first_low])])[0]), Math.max(1, extent([list.flatMap((i) => [i.first_high, i.total_high])])[1])] },
    caption: `Part of the variance of ${a.influences_of_probability ? `whether ${isTime(a) ? `a member fails within ${span(a.probability.by)}` : `it is at most ${quantity(a.probability.by, a.unit)}`}` : `the ${resultName(a)}`} that is owed to each parameter alone (first)${totals ? " and with what it does through the others (total)" : ""}. Thin: 95 % interval by bootstrap.`,
    lines: [...bar("first", "first", "run", totals ? 0.17 : 0), ...(totals ? bar("total", "total", "fit", -0.17) : [])],
    readout: (i) => `${list[i].parameter}: first ${told(list[i], "first")}${totals ? `, total ${told(list[i], "total")}` : ""}`,
    table: { n: list.length, caption: "what decides", columns: [["Parameter", (i) => list[i].parameter], ["First", (i) => told(list[i], "first")], ["Total", (i) => told(list[i], "total")],
      ["Rank correlation", (i) => number(list[i].rank_correlation, 2)]] },
  });
}

function decidesSection(data) {
  const { sweep } = data, a = sweep.answers, section = openSection("decides", "What decides", a.probability ? "Of all that was varied, how much each parameter owns of what differs." : "What each parameter does alone.");
  if (a.swings.length) section.append(swingChart(sweep));
  else if (a.influences.some((i) => i.first !== null)) section.append(influenceChart(sweep));
  else section.append(element("p", { class: "note" }, "Not known: nothing differs, or too few members tell."));
  return section;
}

function fanSection(data) {
  const { fan } = data.sweep, line = { [fan.clock ? "time" : "x"]: fan.place }, [q05, q25, q50, q75, q95] = fan.rate;
  const section = openSection("fan", "The members in time", "Slip rate of all members that are not broken; one that has failed counts as faster than all.");
  section.append(figure({
    title: "Slip rate", caption: "Shaded: 90 % and 50 % of the members. A line ends where so many have failed.",
    x: fan.clock ? { clock: true, axis: "time" } : { kind: "log", label: fan.label, tick: powerTick }, y: { kind: "log", label: "Slip rate (m/s)", tick: powerTick }, read: 2,
    lines: [{ ...line, name: "90 %", kind: "area", colour: "run", y: q50, low: q05, high: q95 }, { ...line, name: "50 %", kind: "area", inner: true, colour: "run", y: q50, low: q25, high: q75 }, { ...line, name: "median", kind: "line", colour: "run", y: q50 }],
    readout: (i) => `${fan.clock ? moment(page.clock, fan.place[i]) : number(fan.place[i])}: median ${rate(q50[i])}, 90 % ${rate(q05[i])} to ${rate(q95[i])}`,
  }));
  return section;
}

// Small charts of each two of some columns, those that fail and those that never do apart.
function matrixOf(sides, failed) {
  const size = 150, gap = 16, left = 24, n = sides.length - 1, place = (k) => left + k * (size + gap), foot = place(n) - left + 10;
  const at = sides.map((side) => { const [low, high] = extent([side.value]); return (v) => (v === null ? NaN : 6 + ((size - 12) * (v - low)) / (high - low || 1)); });
  const picture = svg("svg", { viewBox: `0 0 ${place(n)} ${foot + 8}`, role: "img", "aria-label": "Members, each two of what was drawn and of when they fail" });
  for (let row = 1; row <= n; row++) {
    const top = place(row - 1) - left, middle = top + size / 2;
    picture.append(svg("text", { class: "name", x: 12, y: middle, transform: `rotate(-90 12 ${middle})`, "text-anchor": "middle" }, sides[row].name));
    picture.append(svg("text", { class: "name", x: place(row - 1) + size / 2, y: foot, "text-anchor": "middle" }, sides[row - 1].name));
    for (let col = 0; col < row; col++) {
      const group = svg("g", { transform: `translate(${place(col)} ${top})` }, svg("rect", { class: "pane", width: size, height: size }));
      sides[row].value.forEach((v, i) => {
        const x = at[col](sides[col].value[i]), y = size - at[row](v);
        if (Number.isFinite(x) && Number.isFinite(y)) group.append(svg("circle", { class: `dot full f-${failed[i] ? "fast" : "run"}`, cx: x.toFixed(1), cy: y.toFixed(1), r: 2, opacity: 0.6 }));
      });
      picture.append(group);
    }
  }
  return picture;
}

function membersSection(data) {
  const { sweep } = data, names = shortNames(sweep.drawn.map((d) => d.parameter));
  const sides = [...sweep.drawn.map((d, k) => ({ name: names[k], value: d.value })).slice(0, MOST_SIDES), { name: resultName(sweep.answers), value: sweep.result }];
  const failed = sweep.result.map((t) => t !== null && isTime(sweep.answers)), of = isTime(sweep.answers) ? "when they fail" : `their ${resultName(sweep.answers)}`;
  const section = openSection("members", "Members", `${sweep.result.length < sweep.answers.members ? `${count(sweep.result.length)} of ${many(sweep.answers.members, "member")}` : many(sweep.answers.members, "member")}, each two of what was drawn${names.length > MOST_SIDES ? ` (the first ${MOST_SIDES})` : ""} and of ${of}.`);
  section.append(element("figure", { class: "matrix" }, element("h3", {}, "Members one by one"), element("div", { class: "frame" }, matrixOf(sides, failed)),
    element("figcaption", {}, isTime(sweep.answers) ? "Orange: fails within its time. Blue: never does, or is broken; it stands in no row of the time of failure." : "A member without it stands in no row of it.")));
  return section;
}
