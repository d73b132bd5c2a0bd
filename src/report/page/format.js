// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers, quantities and times in words.
"use strict";

const MINUTE = 60, HOUR = 3600, DAY = 86400, YEAR = 365.25 * DAY;
const THIN = "\u2009"; // between a number and its unit
const MINUS = "\u2212";

function number(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) {
    const [mantissa, power] = value.toExponential(Math.min(digits, 3) - 1).split("e");
    return `${mantissa.replace("-", MINUS)}${THIN}×${THIN}10${raised(Number(power))}`;
  }
  const text = Number(value.toPrecision(digits)).toString().replace("-", MINUS);
  return size >= 1e4 ? text.replace(/\B(?=(\d{3})+(?!\d))/g, THIN) : text;
}

function raised(power) {
  return String(power).replace(/./g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]));
}

function count(value) {
  return value === null || value === undefined ? "–" : Math.round(value).toString().replace(/\B(?=(\d{3})+(?!\d))/g, THIN);
}

// "1 cell" and "2 cells".
const many = (n, word) => `${count(n)} ${word}${n === 1 ? "" : "s"}`;

// A value in the largest of these units of which it holds at least one, as it is written: not "60 s".
function inUnits(value, units, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const [unit, scale] = size === 0 ? units.find(([, s]) => s === 1) : units.find(([, s]) => Number((size / s).toPrecision(digits)) >= 1) || units[units.length - 1];
  return counted(number(value / scale, digits), unit);
}

// "1 day" and "1.5 days".
function counted(text, unit, gap = THIN) {
  const one = { years: "year", days: "day" }[unit];
  return `${text}${gap}${one && text.replace(MINUS, "") === "1" ? one : unit}`;
}

const LENGTHS = [["km", 1e3], ["m", 1], ["cm", 0.01], ["mm", 1e-3], ["µm", 1e-6], ["nm", 1e-9]];
const PRESSURES = [["GPa", 1e9], ["MPa", 1e6], ["kPa", 1e3], ["Pa", 1]];
const FORCES = [["TN", 1e12], ["GN", 1e9], ["MN", 1e6], ["kN", 1e3], ["N", 1]];
const SPANS = [["years", YEAR], ["days", DAY], ["h", HOUR], ["min", MINUTE], ["s", 1], ["ms", 1e-3], ["µs", 1e-6], ["ns", 1e-9]];

const length = (value, digits) => inUnits(value, LENGTHS, digits);
const pressure = (value, digits) => inUnits(value, PRESSURES, digits);
const force = (value, digits) => inUnits(value, FORCES, digits);
const span = (value, digits) => inUnits(value, SPANS, digits);

// Slip rates as people say them: a creep in mm/day, a failure in m/s.
function rate(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value) * DAY;
  if (Math.abs(value) >= 1e-3) return `${length(value, digits)}/s`;
  if (size >= 1) return `${number(value * DAY, digits)}${THIN}m/day`;
  if (size >= 1e-5) return `${number(value * DAY * 1e3, digits)}${THIN}mm/day`;
  return `${number(value * YEAR * 1e3, digits)}${THIN}mm/year`;
}

const angle = (value, digits = 4) => `${number((value * 180) / Math.PI, digits)}°`;

// A quantity in words, by its SI unit.
function quantity(value, unit) {
  const known = { m: length, "m/s": rate, rad: angle, Pa: pressure, s: span, N: force }[unit];
  return value === null || value === undefined ? "–" : known ? known(value) : `${number(value)}${unit === "1" ? "" : `${THIN}${unit}`}`;
}

// Where in a list a value stands nearest.
function nearestOf(values, value) {
  let best = 0;
  for (let k = 1; k < values.length; k++) if (Math.abs(values[k] - value) < Math.abs(values[best] - value)) best = k;
  return best;
}

const plain = (digits) => (value, more = 0) => number(value, digits + more);

// Beyond the year 9999 no date is written, and soon none is known: there time counts from the start.
const LAST_DATE = Date.UTC(10000, 0) / 1000;

// Of dates that say no zone.
const FILES_CLOCK = "the file's clock";

// A time of the run: a date where it has one.
function date(seconds, detail = "minute") {
  const at = new Date(seconds * 1000);
  if (Number.isNaN(at.getTime())) return "–";
  const text = at.toISOString();
  if (detail === "day") return text.slice(0, 10);
  return `${text.slice(0, 10)} ${text.slice(11, { second: 19, millisecond: 23 }[detail] || 16)}`;
}

function moment(clock, seconds) {
  if (seconds === null || !Number.isFinite(seconds)) return "–";
  return clock.dated ? `${date(clock.start + seconds)}${clock.zone && THIN + clock.zone}` : span(seconds, 6);
}

function beforeEnd(clock, before) {
  if (before === 0) return clock.end === "now" ? "now" : `at ${clock.end}`;
  return `${span(before)} before ${clock.end}`;
}
