// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run that goes on: it asks every second where the run stands, is given the data that
// it does not have, draws them, and leaves what its reader holds where it is.
"use strict";

const live = { asking: false, timer: 0, later: 0, last: null, forecasts: undefined, ready: null, held: false, touched: 0, moved: 0, gliding: false };

const STATES = {
  preparing: ["Preparing", "The scene is being made; the charts come with its first steps."],
  running: ["Running", ""],
  complete: ["Complete", "The joint did not fail."],
  failure: ["Failed", "The joint failed, and with it the run is complete."],
  interrupted: ["Stopped", "The run was stopped."],
  failed: ["Broken off", "The computation broke off."],
  lost: ["No connection", "Trying again. If the run was killed, its file holds what came before."],
};

const over = (state) => ["complete", "failure", "interrupted", "failed"].includes(state);

function whereWords(event) {
  if (!(event.end > 0)) return "";
  const clock = page.clock, dated = clock && clock.dated;
  const at = dated ? date(clock.start + event.time) : span(event.time, 4);
  const end = over(event.state) ? "" : dated ? `, to ${date(clock.start + event.end, "day")}` : ` of ${span(event.end, 4)}`;
  return `${at}${end} · ${rate(event.rate)} · ${many(event.steps, "step")}`;
}

// "It stopped." and why: "It stopped: why."
const withMessage = (words, message) => (message ? `${words.replace(/\.$/, ": ")}${message.replace(/\.$/, "")}.` : words);

function afterWords(event, state) {
  const missing = event.missing ? "Memory was short: of what the run has put out some is missing here; its file holds all." : "";
  const words = [withMessage(STATES[state][1], state === "lost" ? "" : event.message), missing].filter((text) => text).join(" ");
  const file = page.data ? page.data.about.file : "";
  return over(state) && file ? [`${words} This page stays as it is; `, element("code", {}, `lacuna report ${file}`), " makes a file of it."] : [words];
}

function showState(event, state = event.state) {
  const [name, words] = STATES[state];
  const strip = document.getElementById("now"), part = document.getElementById("part"), said = document.getElementById("state-said");
  strip.hidden = false;
  strip.dataset.state = state;
  document.getElementById("live").hidden = over(state);
  document.getElementById("state").textContent = name;
  document.getElementById("where").textContent = whereWords(event);
  document.getElementById("after").replaceChildren(...afterWords(event, state).filter((text) => text));
  part.hidden = over(state) || !(event.end > 0);
  part.value = event.end > 0 ? Math.min(1, event.time / event.end) : 0;
  if (said.dataset.state !== state) said.textContent = `${name}. ${words}`;
  said.dataset.state = state;
}

// Something by its place on the page, which is made anew: the figure or section, and which of its kind.
function keyOf(node) {
  const figure = node.closest("figure"), home = figure || node.closest("section") || document.body;
  const name = figure ? `${figure.closest("section").id}/${figure.querySelector("h3").textContent}` : home.id;
  return `${name}/${node.tagName}${[...home.querySelectorAll(node.tagName)].indexOf(node)}`;
}

const all = (selector) => [...document.getElementById("main").querySelectorAll(selector)];
const byKey = (selector) => new Map(all(selector).map((node) => [keyOf(node), node]));

// Where a reader of a list of times stands: at its end, which goes on, or at a time.
const placeIn = (times, index) => (index >= times.length - 1 ? Infinity : times[index]);

const placeOf = (times, place) => (place === Infinity ? times.length - 1 : nearestOf(times, place));

const readTimes = (chart) => lineRead(chart.spec).time || lineRead(chart.spec).x;

function anchor() {
  const node = all("figure").find((n) => n.getBoundingClientRect().bottom > 80) || null;
  return window.scrollY > 0 && node ? { key: keyOf(node.querySelector("h3")), top: node.getBoundingClientRect().top } : null;
}

function keepPlace() {
  const active = document.activeElement;
  return {
    focus: active && active !== document.body && document.getElementById("main").contains(active) ? keyOf(active) : null,
    sliders: new Map(all("input[type=range]").map((n) => [n.id, placeIn(n.times || [], Number(n.value))])),
    selects: new Map(all("select").map((n) => [n.id, n.value])),
    open: new Map(all("details").map((n) => [keyOf(n), n.open])),
    scrolled: new Map(all(".scroll, .plain, pre").map((n) => [keyOf(n), [n.scrollTop, n.scrollLeft]])),
    read: new Map(page.charts.filter((c) => Number.isInteger(c.at)).map((c) => [c.spec.title, placeIn(readTimes(c), c.at)])),
    anchor: anchor(), scroll: window.scrollY,
  };
}

function restoreControls(kept) {
  for (const select of all("select")) {
    if (kept.selects.has(select.id) && select.value !== kept.selects.get(select.id)) {
      select.value = kept.selects.get(select.id);
      select.dispatchEvent(new Event("change"));
    }
  }
  for (const input of all("input[type=range]")) {
    const place = kept.sliders.has(input.id) ? kept.sliders.get(input.id) : Infinity; // the newest at first
    input.value = String(placeOf(input.times || [0], place));
    input.dispatchEvent(new Event("input"));
  }
}

function restoreTables(kept) {
  for (const details of all("details")) {
    const open = kept.open.get(keyOf(details));
    if (open !== undefined && open !== details.open) {
      details.open = open;
      details.dispatchEvent(new Event("toggle")); // what it builds is wanted at once
    }
  }
  for (const node of all(".scroll, .plain, pre")) [node.scrollTop, node.scrollLeft] = kept.scrolled.get(keyOf(node)) || [0, 0];
}

function restorePlace(kept) {
  restoreControls(kept);
  restoreTables(kept);
  for (const chart of page.charts) {
    if (kept.read.has(chart.spec.title)) readOff(chart, placeOf(readTimes(chart), kept.read.get(chart.spec.title)));
  }
  if (kept.focus) byKey("[tabindex], input, select, button, summary").get(kept.focus)?.focus({ preventScroll: true });
  window.scrollTo({ top: kept.scroll, behavior: "instant" });
  const there = kept.anchor && byKey("h3").get(kept.anchor.key)?.closest("figure");
  if (there) window.scrollBy({ top: there.getBoundingClientRect().top - kept.anchor.top, behavior: "instant" });
}

// A page on its way to where a link or a key leads; not every browser says when it is there.
const moves = () => Date.now() - live.moved < (live.gliding ? 2000 : 250);

function noteMove(event) {
  live.moved = Date.now();
  live.gliding = event.type !== "scrollend" && "onscrollend" in window;
}

// What is dragged, played, selected, chosen from or on its way must not be pulled away.
function busy() {
  const choosing = document.activeElement?.tagName === "SELECT" && Date.now() - live.touched < 5000;
  return live.held || moves() || choosing || document.querySelector("[data-playing]") !== null || !window.getSelection().isCollapsed;
}

function showData(data) {
  const first = page.data === null;
  const kept = keepPlace();
  if (first) begin(data);
  else show(data);
  document.title = data.about.title || data.about.file;
  document.querySelector("#axis input[value=before]").nextSibling.textContent = `Time to ${page.clock.end}`;
  restorePlace(kept);
  if (live.last) showState(live.last);
}

function drawReady() {
  if (live.ready === null || (document.hidden && !over(live.last.state))) return;
  clearTimeout(live.later);
  if (busy()) {
    live.later = setTimeout(drawReady, 300);
    return;
  }
  const data = live.ready;
  live.ready = null;
  showData(data);
}

function take({ run, ...data }) {
  live.last = run;
  showState(run);
  if (!data.about) return;
  data.forecasts = live.forecasts = data.forecasts || live.forecasts; // they come more rarely
  live.ready = data;
  drawReady();
}

async function ask() {
  if (live.asking || live.last?.last) return;
  live.asking = true;
  clearTimeout(live.timer);
  const told = await fetch(`data?since=${live.last?.version || 0}`, { cache: "no-store" }).then((answer) => answer.json()).catch(() => null);
  live.asking = false;
  live.timer = setTimeout(ask, document.hidden ? 4000 : 1000);
  if (told) take(told);
  else showState(live.last || { state: "lost", message: "" }, "lost");
}

function startLive() {
  page.live = true;
  document.getElementById("title").textContent = "Lacuna";
  for (const [event, held] of [["pointerdown", true], ["pointerup", false], ["pointercancel", false]]) {
    window.addEventListener(event, () => { live.held = held; });
  }
  for (const event of ["pointerdown", "keydown", "focusin"]) window.addEventListener(event, () => { live.touched = Date.now(); });
  for (const event of ["scroll", "scrollend"]) document.addEventListener(event, noteMove);
  document.addEventListener("click", (event) => { if (event.target.closest("a")) noteMove(event); });
  document.addEventListener("visibilitychange", () => { drawReady(); ask(); });
  ask();
}
