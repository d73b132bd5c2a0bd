// SPDX-License-Identifier: GPL-3.0-or-later
// Axes: from a range of values to places, and where ticks stand.
"use strict";

function extent(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (value !== null && Number.isFinite(value)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

function extentPositive(lists) {
  return extent(lists.map((list) => list.filter((v) => v > 0)));
}

const range = (first, last, step) => {
  const all = [];
  for (let k = Math.ceil(first / step - 1e-9); k * step <= last + 1e-9 * step; k++) all.push(k * step);
  return all;
};

function evenStep(span, most) {
  const raw = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5, 10].find((m) => m * power >= raw) || 10);
}

// `scale`: what one of the unit that is shown measures in SI, so that ticks are round in it.
function linear([low, high], most, format, scale = 1) {
  if (low === high) [low, high] = low === 0 ? [0, 1] : [low - Math.abs(low) * 0.05, high + Math.abs(high) * 0.05];
  const step = scale * evenStep((high - low) / scale, most);
  return {
    low, high,
    at: (v) => (v === null ? NaN : (v - low) / (high - low)),
    ticks: range(low, high, step).map((v) => ({ value: v, label: format(Math.abs(v) < step * 1e-6 ? 0 : v) })),
  };
}

// Decades; every second, third ... where they are many, 2 and 5 between where they are few.
function logarithmic([low, high], most, format) {
  if (!(low > 0)) [low, high] = [1, 10];
  if (low === high) [low, high] = [low / 2, high * 2];
  const from = Math.log10(low), to = Math.log10(high), ticks = [];
  const step = Math.max(1, Math.ceil((to - from) / Math.max(1, most)));
  const between = to - from < 2.2 ? [1, 2, 5] : [1];
  for (let k = Math.floor(from); k <= to; k++) {
    for (const m of between) {
      const value = m * 10 ** k;
      if (k % step === 0 && value >= low * 0.999 && value <= high * 1.001) ticks.push({ value, label: format(value) });
    }
  }
  return { low, high, at: (v) => (v > 0 ? (Math.log10(v) - from) / (to - from) : NaN), ticks };
}

// Time before the end, running to it: the ticks people know.
const KNOWN_SPANS = [
  [1e-9, "1 ns"], [1e-8, "10 ns"], [1e-7, "100 ns"], [1e-6, "1 µs"], [1e-5, "10 µs"], [1e-4, "100 µs"], [1e-3, "1 ms"],
  [0.01, "10 ms"], [0.1, "100 ms"], [1, "1 s"], [10, "10 s"], [MINUTE, "1 min"], [10 * MINUTE, "10 min"], [HOUR, "1 h"],
  [10 * HOUR, "10 h"], [DAY, "1 day"], [10 * DAY, "10 days"], [100 * DAY, "100 days"], [YEAR, "1 year"], [10 * YEAR, "10 years"],
  [100 * YEAR, "100 years"], [1000 * YEAR, "1000 years"],
];

function remaining([low, high], most) {
  if (!(low > 0)) [low, high] = [1e-3, 1];
  if (low === high) low = high / 10;
  const from = Math.log10(high), to = Math.log10(low);
  let ticks = KNOWN_SPANS.filter(([v]) => v >= low && v <= high).map(([value, label]) => ({ value, label }));
  const every = Math.ceil(ticks.length / Math.max(2, most));
  ticks = ticks.filter((_, i) => i % every === 0);
  return { low, high, at: (v) => (v > 0 ? (Math.log10(v) - from) / (to - from) : v === 0 ? 1 : NaN), ticks };
}

// The same, growing.
function spans(ends, most) {
  const turned = remaining(ends, most);
  return { ...turned, at: (v) => (v > 0 ? 1 - turned.at(v) : NaN) };
}

const STEPS = [1, 5, 15, 30, 60, 300, 900, 1800, 3600, 10800, 21600, 43200, DAY, 2 * DAY, 7 * DAY, 14 * DAY];

function monthTicks(start, low, high, most) {
  const first = new Date((start + low) * 1000);
  const months = (high - low) / (30.44 * DAY);
  const every = [1, 2, 3, 6, 12, 24, 60, 120, 240, 600, 1200].find((m) => months / m <= most) || 2400;
  const ticks = [];
  let month = first.getUTCFullYear() * 12 + first.getUTCMonth();
  for (month = Math.floor(month / every) * every; ; month += every) {
    const at = new Date(0);
    at.setUTCFullYear(Math.floor(month / 12), month % 12, 1);
    const value = at.getTime() / 1000 - start;
    if (value > high) return ticks;
    const year = at.getUTCMonth() === 0 || every >= 12;
    const name = at.toISOString().slice(0, 7);
    if (value >= low) ticks.push({ value, label: every >= 12 ? name.slice(0, 4) : name, year });
  }
}

// Dates in UTC.
function calendar([low, high], most, start) {
  if (low === high) high = low + 1;
  const wide = (high - low) / most;
  const step = STEPS.find((s) => s >= wide);
  const at = (v) => (v === null ? NaN : (v - low) / (high - low));
  if (step === undefined) return { low, high, at, ticks: monthTicks(start, low, high, most) };
  const detail = step >= DAY ? "day" : "minute";
  const label = (t) => (detail === "day" ? date(t, "day").slice(5) : date(t, step < 60 ? "second" : "minute").slice(11));
  const ticks = range(start + low, start + high, step).map((t) => ({ value: t - start, label: label(t) }));
  return { low, high, at, ticks };
}

// Seconds since the start, in the unit that their range asks for.
function elapsed([low, high], most) {
  const [unit, scale] = SPANS.find(([, s]) => (high - low) / s >= 2) || SPANS[SPANS.length - 1];
  const inner = linear([low / scale, high / scale], most, plain(5));
  return {
    low, high, unit, at: (v) => (v === null ? NaN : inner.at(v / scale)),
    ticks: inner.ticks.map((t) => ({ value: t.value * scale, label: t.label })),
  };
}
