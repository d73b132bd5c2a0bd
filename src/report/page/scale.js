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
  const all = [], most = Math.max(Math.abs(first), Math.abs(last)) / step;
  if (!(most < 2 ** 53)) return all; // one step more would be none
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
  const step = scale * evenStep((high - low) / scale, most), values = range(low, high, step).map((v) => (Math.abs(v) < step * 1e-6 ? 0 : v));
  const digits = [0, 3, 6].find((more) => new Set(values.map((v) => format(v, more))).size === values.length) ?? 6;
  return {
    low, high,
    at: (v) => (v === null ? NaN : (v - low) / (high - low)),
    back: (p) => low + p * (high - low),
    ticks: values.map((v) => ({ value: v, label: format(v, digits) })),
  };
}

// Decades; every second, third ... where they are many, 2 and 5 between where they are few.
function logarithmic([low, high], most, format) {
  if (!(low > 0)) [low, high] = [1, 10];
  if (low === high) [low, high] = [low / 2 || low, Math.min(high * 2, Number.MAX_VALUE)];
  const from = Math.log10(low), to = Math.log10(high), ticks = [];
  const step = Math.max(1, Math.ceil((to - from) / Math.max(1, most)));
  const between = to - from < 2.2 ? [1, 2, 5] : [1];
  for (let k = Math.floor(from); k <= to; k++) {
    for (const m of between) {
      const value = m * 10 ** k;
      if (k % step === 0 && value >= low * 0.999 && value <= high * 1.001) ticks.push({ value, label: format(value) });
    }
  }
  // less than a decade is told by even ticks where 1, 2 and 5 leave fewer than two
  if (ticks.length < 2) ticks.splice(0, ticks.length, ...linear([low, high], most, format).ticks.filter((t) => t.value > 0));
  return { low, high, at: (v) => (v > 0 ? (Math.log10(v) - from) / (to - from) : NaN), back: (p) => 10 ** (from + p * (to - from)), ticks };
}

// Time before the end, running to it: the ticks people know.
const KNOWN_SPANS = [
  [1e-9, "1 ns"], [1e-8, "10 ns"], [1e-7, "100 ns"], [1e-6, "1 µs"], [1e-5, "10 µs"], [1e-4, "100 µs"], [1e-3, "1 ms"],
  [0.01, "10 ms"], [0.1, "100 ms"], [1, "1 s"], [10, "10 s"], [MINUTE, "1 min"], [10 * MINUTE, "10 min"], [HOUR, "1 h"],
  [10 * HOUR, "10 h"], [DAY, "1 day"], [10 * DAY, "10 days"], [100 * DAY, "100 days"], [YEAR, "1 year"], [10 * YEAR, "10 years"],
  [100 * YEAR, "100 years"], [1000 * YEAR, "1000 years"],
];

// Ticks where those that people know are too few: 1, 2, 5 ... of one unit, or even ones.
function denseSpans(low, high, most) {
  const [unit, scale] = SPANS.find(([, s]) => low >= s) || SPANS[SPANS.length - 1];
  const tick = (n) => ({ value: n * scale, label: counted(number(n, 6), unit, " ") });
  const [from, to] = [low / scale, high / scale];
  if (to < 3 * from) return range(from, to, evenStep(to - from, most)).map(tick);
  const all = [];
  for (let k = Math.floor(Math.log10(from)); 10 ** k <= to; k++) all.push(...[1, 2, 5].map((m) => m * 10 ** k));
  return all.filter((n) => n >= from && n <= to).map(tick);
}

function remaining([low, high], most) {
  if (!(low > 0)) [low, high] = [1e-3, 1];
  if (low === high) low = high / 10 || high;
  const from = Math.log10(high), to = Math.log10(low);
  let ticks = KNOWN_SPANS.filter(([v]) => v >= low && v <= high).map(([value, label]) => ({ value, label }));
  if (ticks.length < 3) ticks = denseSpans(low, high, most);
  const every = Math.ceil(ticks.length / Math.max(2, most));
  ticks = ticks.filter((_, i) => i % every === 0);
  return { low, high, at: (v) => (v > 0 ? (Math.log10(v) - from) / (to - from) : v === 0 ? 1 : NaN), back: (p) => 10 ** (from + p * (to - from)), ticks };
}

// The same, growing.
function spans(ends, most) {
  const turned = remaining(ends, most);
  return { ...turned, at: (v) => (v > 0 ? 1 - turned.at(v) : NaN), back: (p) => turned.back(1 - p) };
}

// A part of an axis, from one fraction of it to another; `make` builds the axis of a range.
function enlarged(whole, [from, to], make) {
  const ends = [whole.back(from), whole.back(to)].sort((a, b) => a - b);
  const part = make(ends), wide = to - from;
  return { ...part, low: ends[0], high: ends[1], at: (v) => (whole.at(v) - from) / wide, back: (p) => whole.back(from + p * wide), whole };
}

const STEPS = [0.001, 0.01, 0.1, 1, 5, 15, 30, 60, 300, 900, 1800, 3600, 10800, 21600, 43200, DAY, 2 * DAY, 7 * DAY, 14 * DAY];

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
  const back = (p) => low + p * (high - low);
  if (step === undefined) return { low, high, at, back, ticks: monthTicks(start, low, high, most) };
  const detail = step >= DAY ? "day" : "minute";
  const clock = step < 1 ? "millisecond" : step < 60 ? "second" : "minute";
  const label = (t) => (detail === "day" || (clock === "minute" && t % DAY === 0) ? date(t, "day").slice(5) : date(t, clock).slice(11));
  const ticks = range(start + low, start + high, step).map((t) => ({ value: t - start, label: label(t) }));
  return { low, high, at, back, ticks };
}

// Seconds since the start, in the unit that their range asks for.
function elapsed([low, high], most) {
  const [unit, scale] = SPANS.find(([, s]) => (high - low) / s >= 2) || SPANS[SPANS.length - 1];
  const inner = linear([low / scale, high / scale], most, plain(5));
  return {
    low, high, unit, at: (v) => (v === null ? NaN : inner.at(v / scale)), back: (p) => low + p * (high - low),
    ticks: inner.ticks.map((t) => ({ value: t.value * scale, label: t.label })),
  };
}
