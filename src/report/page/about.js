// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, in words; the case; where it all comes from.
"use strict";

function verdict(data) {
  const a = data.about, m = data.motion, n = m.time.length;
  const first = m.rate.find((v) => v > 0) ?? null, slip = length(a.mean_slip_m ?? m.slip[n - 1], 3);
  const from = first === null ? "From rest" : `From ${rate(first)}`;
  if (a.failed) {
    const when = page.clock.dated && a.failure_date ? `, on ${a.failure_date.slice(0, 10)} at ${a.failure_date.slice(11, 16)} UTC` : "";
    return `${from} the joint crept, accelerated and failed after ${span(a.failure_time_s, 5)}${when}, having slipped ${slip}.`;
  }
  const reached = span(a.time_reached_s ?? m.time[n - 1], 4);
  const states = { running: "The run goes on", interrupted: "The run was stopped", failed: "The computation broke off" };
  if (a.status in states) return `${states[a.status]}; by ${reached} the joint has slipped ${slip} and moves at ${rate(m.rate[n - 1])}.`;
  return `${from} the joint slipped ${slip} in ${reached} and did not fail; at the end it moves at ${rate(m.rate[n - 1])}${a.arrest && a.arrest.startsWith("arrested") ? ", less than a tenth of its fastest: it was arrested" : ""}.`;
}

function facts(data) {
  const a = data.about, m = data.motion, list = [];
  const add = (name, value, small) => value && value !== "–" && list.push([name, value, small]);
  if (a.failed) add("Failure after", span(a.failure_time_s, 5), a.failure_date ? a.failure_date.replace("T", " ").replace("Z", " UTC") : "");
  else add("Time reached", span(a.time_reached_s ?? m.time[m.time.length - 1], 4), a.ended_by || "");
  add("Mean slip", length(a.mean_slip_m ?? m.slip[m.slip.length - 1], 4));
  add("Largest slip rate", rate(a.max_slip_rate_m_s ?? extent([m.max_rate])[1]), "of any cell");
  if (a.factor_of_safety_least !== undefined) {
    const below = a.factor_of_safety_below_1_time_s;
    add("Least factor of safety", number(a.factor_of_safety_least, 4), below === undefined ? "" : below === 0 ? "below 1 from the start" : `below 1 from ${moment(page.clock, below)} on`);
  }
  if (data.cells) add("Contact cells", count(data.cells.cells), `of a grid of ${count(a.grid_nx)} × ${count(a.grid_ny)}`);
  if (data.events) add("Events", count(data.events.all));
  if (a.steps !== undefined) add("Steps", count(a.steps), many(a.rhs_evaluations, "evaluation"));
  if (a.wall_time_s !== undefined) add("Computed in", span(a.wall_time_s, 3));
  return list;
}

function fillHead(data) {
  const r = data.readings, e = data.sweep;
  document.getElementById("kind").textContent = r ? "readings" : e ? "ensemble" : "run";
  document.getElementById("title").textContent = r ? r.name : data.about.title || data.about.file;
  document.getElementById("verdict").textContent = r ? readingsVerdict(data) : e ? ensembleVerdict(data) : verdict(data);
  document.getElementById("said").replaceChildren(...(r ? [verdictLines(data)] : []));
  const list = document.getElementById("facts");
  list.replaceChildren();
  for (const [name, value, small, level] of r ? readingsFacts(data) : e ? ensembleFacts(data) : facts(data)) {
    const dd = element("dd", level === undefined ? {} : { class: `level-now l-${level}` }, value);
    if (small) dd.append(element("small", {}, small));
    list.append(element("div", {}, element("dt", {}, name), dd));
  }
  const a = data.about;
  document.getElementById("made").textContent = `Made ${a.made.replace("T", " ").replace("Z", " UTC")} by ${a.made_by} from ${a.file}. The numbers are thinned to what a screen can show; the file holds all.`;
}

function provenance(data) {
  const a = data.about, b = a.boundary;
  const rows = [["File", a.file], ["Status", a.status], ["Ended by", a.ended_by], ["Made by", a.source], ["Institution", a.institution], [data.readings || data.sweep ? "Made" : "Run", a.history],
    ["Resumed", a.resumed], ["Libraries", a.libraries], ["Seed", a.seed === undefined ? undefined : String(a.seed)], ["Resolved in time", a.fidelity],
    ["Grid", a.grid_nx === undefined ? undefined : `${count(a.grid_nx)} × ${count(a.grid_ny)} cells of ${length(a.grid_dx_m)}, ${b || ""}`],
    ["Records", count(a.records)], ["Worst balance residual", a.balance_residual_max === undefined ? undefined : number(a.balance_residual_max, 3)],
    ["References", a.references]].filter(([, v]) => v);
  return element("div", { class: "plain" }, bareTable("Provenance", rows.length, [["What", (i) => rows[i][0]], ["Value", (i) => rows[i][1], "text"]]));
}

function aboutSection(data) {
  const section = data.readings || data.sweep ? openSection("provenance", "Provenance", `Where ${data.sweep ? "the members" : "the readings and the forecasts"} come from.`)
    : openSection("case", "Case and provenance", "All that is needed to make this run again: the case with every default filled in, as lacuna run reads it.");
  section.append(provenance(data));
  if (data.about.case) {
    const details = element("details", { class: "case", open: "" }, element("summary", {}, "The case"));
    details.append(element("pre", { tabindex: "0", "aria-label": "The case" }, data.about.case));
    section.append(details);
  }
  return section;
}
