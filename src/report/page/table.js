// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers behind a chart.
"use strict";

const MOST_ROWS = 60;

// Which of n rows stand in a table: all, or evenly many by number and the last.
function rowsOf(n) {
  if (n <= MOST_ROWS) return Array.from({ length: n }, (_, i) => i);
  return Array.from({ length: MOST_ROWS }, (_, k) => Math.round((k * (n - 1)) / (MOST_ROWS - 1)));
}

// columns: [[heading, row => text, class?]]
function bareTable(caption, n, columns) {
  const head = element("tr");
  for (const [heading, , look] of columns) head.append(element("th", { scope: "col", class: look || "" }, heading));
  const body = element("tbody");
  for (const i of rowsOf(n)) {
    const row = element("tr");
    for (const [, cell, look] of columns) row.append(element("td", { class: look || "" }, cell(i)));
    body.append(row);
  }
  return element("table", {}, element("caption", {}, caption), element("thead", {}, head), body);
}

// Built when it is opened: a page has a dozen of them.
function tableOf({ n, caption, columns }) {
  const shown = Math.min(n, MOST_ROWS);
  const details = element("details", {}, element("summary", {}, `Table: ${caption}`));
  details.addEventListener("toggle", () => {
    if (details.open && !details.querySelector("table")) {
      const words = shown < n ? `${caption}: ${shown} of ${count(n)} rows` : caption;
      details.append(element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
        bareTable(words, n, columns)));
    }
  });
  return details;
}

// First columns of a table over time.
function clockColumns(list) {
  return [["Time", (i) => moment(page.clock, list.time[i])], [`Before ${page.clock.end}`, (i) => span(list.before[i])]];
}
