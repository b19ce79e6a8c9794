// The map editor: cells are painted here; the server draws both views and says what is wrong.
"use strict";

const main = document.querySelector("main.editor");
const part = (id) => document.getElementById(id);
const meanings = Object.fromEntries(
  [...document.querySelectorAll("#palette input")].map((input) => [input.value, input.dataset.meaning]),
);

let rows = main.dataset.rows.split("\n").map((row) => [...row]);
let here = [0, 0];
let isPainting = false;
let asked = 0;
let timer = 0;

const chosen = () => document.querySelector("#palette input:checked").value;
const cell = (row, column) => part("grid").rows[row].cells[column].firstChild;

async function send(path, body) {
  const response = await fetch(path, {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Token": main.dataset.token },
    body: JSON.stringify(body),
  });
  return [response.ok, await response.json()];
}

function build() {
  here = [Math.min(here[0], rows.length - 1), Math.min(here[1], rows[0].length - 1)];
  const grid = part("grid");
  grid.replaceChildren();
  rows.forEach((row, r) => {
    const line = grid.insertRow();
    line.setAttribute("role", "row");
    row.forEach((_, c) => {
      const place = line.insertCell();
      place.setAttribute("role", "gridcell");
      const button = document.createElement("button");
      button.type = "button";
      button.tabIndex = r === here[0] && c === here[1] ? 0 : -1;
      button.addEventListener("pointerdown", (event) => { event.preventDefault(); isPainting = true; go(r, c); paint(r, c); });
      button.addEventListener("focus", () => go(r, c));
      button.addEventListener("pointerenter", () => { if (isPainting) paint(r, c); });
      place.append(button);
      name(r, c);
    });
  });
  look();
}

function name(r, c) {
  const button = cell(r, c);
  button.textContent = rows[r][c] === "." ? "\u00a0" : rows[r][c];
  button.dataset.kind = meanings[rows[r][c]];
  button.setAttribute("aria-label", `row ${r}, column ${c}: ${meanings[rows[r][c]]}`);
}

function paint(r, c) {
  rows[r][c] = chosen();
  name(r, c);
  look();
}

function go(r, c) {
  if (!rows[r] || rows[r][c] === undefined || (here[0] === r && here[1] === c && document.activeElement === cell(r, c))) return;
  cell(...here).tabIndex = -1;
  here = [r, c];
  cell(r, c).tabIndex = 0;
  cell(r, c).focus();
}

function look() {
  clearTimeout(timer);
  timer = setTimeout(async () => {
    const number = (asked += 1);
    const [ok, seen] = await send("/admin/maps/look", { rows: rows.map((row) => row.join("")) });
    if (!ok || number !== asked) return;
    const place = seen.row ? ` (row ${seen.row - 1}, column ${seen.column - 1})` : "";
    part("status").textContent = seen.error ? `Not yet a map: ${seen.error}${place}.` : "Every marked room can be reached.";
    part("save-button").setAttribute("aria-disabled", Boolean(seen.error));
    for (const view of ["human", "robot"]) if (seen[view]) part(view).innerHTML = seen[view];
  }, 120);
}

part("grid").addEventListener("keydown", (event) => {
  const moves = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
  if (moves[event.key]) go(here[0] + moves[event.key][0], here[1] + moves[event.key][1]);
  else if (event.key === "Enter" || event.key === " ") paint(...here);
  else if (meanings[event.key]) {
    document.querySelector(`#palette input[value="${event.key}"]`).checked = true;
    paint(...here);
  } else return;
  event.preventDefault();
});
addEventListener("pointerup", () => { isPainting = false; });

document.querySelectorAll("[data-size]").forEach((button) => button.addEventListener("click", () => {
  const largest = Number(main.dataset.largest);
  const change = button.dataset.size;
  if (change === "row+" && rows.length < largest) rows.push(rows[0].map(() => "."));
  if (change === "row-" && rows.length > 1) rows.pop();
  if (change === "column+" && rows[0].length < largest) rows.forEach((row) => row.push("."));
  if (change === "column-" && rows[0].length > 1) rows.forEach((row) => row.pop());
  build();
}));

part("save").addEventListener("submit", async (event) => {
  event.preventDefault();
  const body = { name: part("name").value, rows: rows.map((row) => row.join("")) };
  const [ok, answer] = await send("/admin/maps/save", body);
  part("status").textContent = ok ? `Saved as ${answer.map}.` : `Not saved: ${answer.error}.`;
});

build();
