// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together from its data; sections without data are left out.
"use strict";

const SECTIONS = [
  ["likely", likelySection], ["fan", fanSection], ["decides", decidesSection], ["members", membersSection],
  ["readings", readingsSection], ["motion", motionSection], ["direction", directionSection], ["points", pointsSection], ["safety", safetySection], ["forecasts", forecastSection], ["fit", fitSection], ["forces", forcesSection], ["cells", cellsSection], ["levels", levelsSection],
  ["events", eventsSection], ["solver", solverSection], ["about", aboutSection],
];

function openSection(id, title, lead) {
  const section = element("section", { id, "aria-labelledby": `${id}-title` });
  section.append(element("h2", { id: `${id}-title` }, title), element("p", { class: "lead" }, lead));
  return section;
}

function makeClock(data) {
  const a = data.about, time = (data.motion || data.readings?.moved || data.sweep).time, last = time[time.length - 1];
  return { dated: a.dated && a.start + last < LAST_DATE, zone: a.time_zone === "not stated" ? "" : "UTC", start: a.start, last, failure: a.failure_time_s ?? null, end: data.readings ? "the last reading" : a.failed ? "failure" : page.live && a.status === "running" ? "now" : "the end" };
}

function choice(id, name, options, current, change) {
  const box = document.getElementById(id);
  for (const [value, label] of options) {
    const input = element("input", { type: "radio", name, value });
    input.checked = value === current;
    input.addEventListener("change", () => change(value));
    box.append(element("label", {}, input, label));
  }
}

function drawAll() {
  for (const chart of page.charts) chart.draw();
}

function fillControls() {
  if (page.data.sweep) document.getElementById("axis").remove();
  else choice("axis", "axis", [["time", page.clock.dated ? "Date" : "Time"], ["before", `Time to ${page.clock.end}`]], page.axis, (value) => {
    page.axis = value;
    for (const chart of page.charts.filter((c) => c.spec.x.clock)) whole(chart);
    drawAll();
  });
  choice("theme", "theme", [["", "As the system"], ["light", "Light"], ["dark", "Dark"]], "", (value) => {
    if (value) document.documentElement.dataset.theme = value;
    else delete document.documentElement.dataset.theme;
  });
}

function fillContents(sections) {
  const list = document.getElementById("contents");
  list.replaceChildren();
  for (const section of sections) {
    list.append(element("li", {}, element("a", { href: `#${section.id}` }, section.querySelector("h2").textContent)));
  }
}

function show(data) {
  Object.assign(page, { data, charts: [], later: [], clock: makeClock(data) });
  fillHead(data);
  const sections = SECTIONS.filter(([key]) => data[key] || data.sweep?.[key]).map(([, make]) => make(data));
  document.getElementById("main").replaceChildren(...sections);
  fillContents(sections);
  drawAll();
  page.later.forEach((act) => act());
}

function begin(data) {
  page.axis = data.about.failed && !data.about.dated && !data.readings && !data.sweep ? "before" : "time";
  show(data);
  fillControls();
  let width = 0;
  new ResizeObserver(() => {
    if (document.body.clientWidth !== width) drawAll();
    width = document.body.clientWidth;
  }).observe(document.body);
  for (const [event, on] of [["beforeprint", true], ["afterprint", false]]) {
    window.addEventListener(event, () => {
      document.documentElement.classList.toggle("paper", on);
      drawAll();
    });
  }
  document.documentElement.dataset.ready = "yes";
}

function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  if (data.live) startLive();
  else begin(data);
}

start();
