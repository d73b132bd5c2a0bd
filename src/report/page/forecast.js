// SPDX-License-Identifier: GPL-3.0-or-later
// Forecasts of the time of failure as they would have been issued, and the window they leave.
"use strict";

// One method at one time of issue, as the data hold it.
const ISSUED = 0, LEFT = 1, LOW90 = 2, LOW50 = 3, HIGH50 = 4, HIGH90 = 5, REASON = 6, ENDS = 7, RAW = 8;

// Of all methods together, where the file has it: the chances of its times, and the middle one.
const EARLY = 0, SOON = 1, MIDDLE = 2, LATE = 3, LAST = 4;
const pooled = (f, i) => (f.pooled && f.pooled[i][MIDDLE] !== null ? f.pooled[i] : null);

const forecastState = { issue: 0, method: -1 };

function chosen(f) {
  const all = f.forecast[forecastState.issue];
  return all.filter((one, m) => one[ISSUED] && (forecastState.method < 0 ? !f.methods[m].baseline : m === forecastState.method));
}

// Bands of the chosen forecasts: of all methods those of the pooled time, else the span of their times and of their 90 %
// intervals; of one its 50 % and 90 % intervals.
function windowBands(f) {
  const from = f.issue[forecastState.issue], issued = chosen(f), all = forecastState.method < 0 && pooled(f, forecastState.issue);
  if (!issued.length) return [];
  const at = (v) => (v === null ? null : from + v);
  if (all) return [{ from: at(all[EARLY]), to: at(all[LAST]) }, { from: at(all[SOON]), to: at(all[LATE]), inner: true }];
  const least = (k) => Math.min(...issued.map((one) => one[k] ?? 0));
  const most = (k) => (issued.some((one) => one[k] === null) ? null : Math.max(...issued.map((one) => one[k])));
  const inner = forecastState.method < 0 ? [least(LEFT), most(LEFT)] : [least(LOW50), most(HIGH50)];
  return [{ from: at(least(LOW90)), to: at(most(HIGH90)) }, { from: at(inner[0]), to: at(inner[1]), inner: true }];
}

function showWindow(f) {
  const issue = { x: f.issue[forecastState.issue], label: "issued" };
  for (const chart of page.charts.filter((c) => c.spec.shows === "window")) {
    chart.spec.bands = windowBands(f);
    chart.spec.marks = [...marksOf(page.data), issue];
    chart.draw();
  }
}

function leftWords(f, one, key) {
  if (one[key] === null) return "never";
  return page.clock.dated ? date(page.clock.start + f.issue[forecastState.issue] + one[key]) : span(one[key], 3);
}

const atEnds = (keys) => (keys.length ? `; the best fit's ${keys.join(" and ")} at the end of the range` : "");

function methodRows(f) {
  const rows = f.forecast[forecastState.issue];
  const cell = (words) => (m) => (rows[m][ISSUED] ? words(rows[m]) : "–");
  const between = (low, high) => cell((one) => (one[low] === null ? "–" : `${leftWords(f, one, low)} to ${leftWords(f, one, high)}`));
  const words = `Forecasts issued ${moment(page.clock, f.issue[forecastState.issue])}${page.clock.dated ? `; dates in ${page.clock.zone || FILES_CLOCK}` : "; times after issue"}`;
  const table = bareTable(words, rows.length, [["Method", (m) => f.methods[m].name],
    ["Failure", cell((one) => leftWords(f, one, LEFT))], ["50 % interval", between(LOW50, HIGH50)], ["90 % interval", between(LOW90, HIGH90)],
    ...(rows.some((one) => one[RAW] !== undefined) ? [["By the fit itself", cell((one) => leftWords(f, one, RAW))]] : []),
    ["What it is, or why it issues none", (m) => `${rows[m][ISSUED] ? f.methods[m].summary : rows[m][REASON]}${atEnds(rows[m][ENDS])}`, "text"]]);
  table.querySelectorAll("tbody tr").forEach((row, m) => row.classList.toggle("refused", !rows[m][ISSUED]));
  return table;
}

const BARS = "Bars: 90 % intervals, of one method, calibrated on simulated failures.";

// All forecasts of a method (or of all) over the times of issue, as dots with 90 % bars.
function issuedDots(f, method, value) {
  const line = { kind: "dots", time: [], before: [], y: [], low: [], high: [], index: [] };
  f.issue.forEach((from, i) => f.forecast[i].forEach((one, m) => {
    if (!one[ISSUED] || (method < 0 ? f.methods[m].baseline : m !== method)) return;
    line.time.push(from);
    line.before.push(Math.max(0, page.clock.last - from));
    line.y.push(value(from, one[LEFT]));
    line.low.push(value(from, one[LOW90]));
    line.high.push(one[HIGH90] === null ? null : value(from, one[HIGH90]));
    line.index.push([i, m]);
  }));
  if (method < 0) delete line.low, delete line.high;
  return line;
}

// Remaining time as forecast against what in truth remained: only of a run that failed.
function lifeSpec(f, method) {
  const dots = { ...issuedDots(f, method, (_, left) => left), name: "forecast", colour: "fast" };
  const truth = { time: [], before: [], y: [] };
  for (const from of f.issue) {
    truth.time.push(from);
    truth.before.push(Math.max(0, page.clock.last - from));
    truth.y.push(page.clock.failure - from > 0 ? page.clock.failure - from : null);
  }
  const high = extentPositive([truth.y])[1], low = extentPositive([truth.y])[0];
  return {
    title: "Time left, as forecast and as it was", x: { clock: true, axis: "before" },
    y: { kind: "spans", label: "Time left", range: [low / 5, high * 30] }, read: 0,
    lines: [dots, { ...truth, name: "what was left", kind: "line", colour: "run" }],
    caption: `A forecast on the line is right; above it is late. ${BARS}`,
    readout: (i) => readForecast(f, dots, i),
  };
}

// Times of failure as forecast, where nothing tells when the slope failed.
function windowSpec(f, method) {
  const dots = { ...issuedDots(f, method, (from, left) => (left === null ? null : from + left)), name: "forecast", colour: "fast" };
  const first = f.issue[0], last = f.issue[f.issue.length - 1];
  const marks = page.clock.failure !== null ? [{ y: page.clock.failure, label: "failure of the run" }] : [];
  return {
    title: "Time of failure, as forecast", x: { clock: true }, marks,
    y: { kind: "clock", label: page.clock.dated ? "Date of failure" : "Time of failure", range: [first, last + 0.75 * (last - first)] },
    lines: [dots, { name: "time of issue", kind: "line", colour: "quiet", dash: true, time: f.issue, before: f.issue.map((t) => Math.max(0, page.clock.last - t)), y: f.issue }],
    caption: `Each dot a forecast at the time when it could have been issued. ${BARS}`,
    readout: (i) => readForecast(f, dots, i),
  };
}

function readForecast(f, dots, i) {
  if (!dots.index.length) return "no forecast";
  const [issue, m] = dots.index[i], one = f.forecast[issue][m];
  const range = one[LOW90] === null ? "" : `, 90 % ${span(one[LOW90], 3)} to ${one[HIGH90] === null ? "never" : span(one[HIGH90], 3)}`;
  return `${f.methods[m].name}, issued ${moment(page.clock, f.issue[issue])}: ${span(one[LEFT], 3)} left${range}`;
}

// Where the page opens: the last reading, or of a run the last issue with a fiftieth of it left.
function firstIssue(f) {
  if (page.data.readings) return f.issue.length - 1;
  const spanned = page.clock.last - f.issue[0];
  const issued = f.issue.map((_, i) => i).filter((i) => f.forecast[i].some((one) => one[ISSUED]));
  const early = issued.filter((i) => page.clock.last - f.issue[i] > spanned / 50);
  return f.measured || !early.length ? issued[issued.length - 1] : early[early.length - 1];
}

function methodChoice(f, change) {
  const select = element("select", { id: "method" });
  select.append(element("option", { value: "-1" }, "all but the baseline"));
  f.methods.forEach((m, i) => select.append(element("option", { value: String(i) }, `${m.name}: ${m.summary}`)));
  select.addEventListener("change", () => change(Number(select.value)));
  return element("label", { class: "pick" }, "Method ", select);
}

function forecastSection(data) {
  const f = data.forecasts;
  const none = data.series && !f.measured ? ` No method issues a forecast from ${data.series.name}.` : "";
  const above = data.readings ? "displacement" : "creep curve";
  const what = f.measured ? `of ${(data.readings || data.series).name}` : "of the run itself, as if it were being watched";
  const section = openSection("forecasts", "Forecasts", `Times of failure forecast from readings ${what}, each from nothing later than its time of issue.${none} The window of the chosen time is shaded in the ${above} and the inverse rate above.`);
  const truthful = !f.measured && data.about.failed;
  const make = () => figure((data.readings ? leftSpec : truthful ? lifeSpec : windowSpec)(f, forecastState.method));
  let chart = make();
  const plain = element("div", { class: "plain" });
  const update = (issue) => {
    forecastState.issue = issue;
    plain.replaceChildren(methodRows(f));
    showWindow(f);
  };
  const choice = methodChoice(f, (method) => {
    forecastState.method = method;
    page.charts.splice(page.charts.indexOf(chart.chart), 1);
    const next = make();
    chart.replaceWith(next);
    chart = next;
    chart.chart.draw();
    update(forecastState.issue);
  });
  forecastState.issue = firstIssue(f);
  const control = slider({ name: "Issued", id: "issue", n: f.issue.length, at: forecastState.issue, times: f.issue,
    words: (i) => `${moment(page.clock, f.issue[i])}, ${chosenCount(f, i)}`, change: update });
  section.append(choice, control, chart, plain);
  page.later.push(() => update(forecastState.issue));
  return section;
}

function chosenCount(f, i) {
  const n = f.forecast[i].filter((one) => one[ISSUED]).length;
  return n === 0 ? "no method issues a forecast" : `${n} of ${f.methods.length} methods issue a forecast`;
}
