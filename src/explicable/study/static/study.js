// A task under way. The server knows where it stands; this page shows it, and sends what the person does.
"use strict";

const main = document.querySelector("main[data-view]");
const part = (id) => document.getElementById(id);
const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;

let view = JSON.parse(main.dataset.view);
let hasStarted = view.number > 0;
let timer = 0;
let shownAt = 0;
let queue = Promise.resolve();
let pending = 0;
let isFinished = false;
let ordered = "";

const patienceMs = 60_000; // a robot that plans may take twenty seconds
const newId = () => Array.from(crypto.getRandomValues(new Uint8Array(16)), (b) => b.toString(16).padStart(2, "0")).join("");
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// One request after another; one that gets no answer is sent again as it was: the server carries it out once.
// A step that was shown without asking is told with the first request after it.
function send(path, body) {
  pending += 1;
  body = { request_id: newId(), client_time: Date.now() / 1000, ...body };
  queue = queue.then(() => deliver(path, { ...body, shown: view.shown })).finally(() => { pending -= 1; });
  return queue;
}

async function deliver(path, body) {
  for (let wait = 500; ; wait = Math.min(2 * wait, 8000)) {
    try {
      const response = await fetch(path, {
        method: "POST",
        headers: { "Content-Type": "application/json", "X-Token": main.dataset.token },
        body: JSON.stringify(body),
        signal: AbortSignal.timeout(patienceMs),
      });
      if (response.ok) return show(await response.json());
      if (response.status === 409) {
        const problem = await response.json();
        if (!problem.view) return location.reload();
        show(problem.view);
        if (path === "/api/command") part("status").textContent = main.dataset.refused;
        return;
      }
      if (response.status < 500 && response.status !== 429) return location.reload();
    } catch (error) {
      if (!(error instanceof TypeError || error.name === "TimeoutError")) throw error;
    }
    part("status").textContent = main.dataset.lost;
    await pause(wait);
  }
}

function show(next) {
  const hasMoved = next.number !== view.number;
  isFinished = next.stage !== view.stage || next.position !== view.position;
  if (isFinished) return finish();
  view = next;
  draw(hasMoved);
  goOn();
}

function draw(hasMoved) {
  if (view.picture) {
    part("picture").innerHTML = view.picture;
    if (calm || !hasMoved) part("picture").querySelectorAll("animateTransform").forEach((a) => a.remove());
  }
  part("status").textContent = sentence();
  const changes = [["became-true", "true-line", view.became_true], ["became-false", "false-line", view.became_false]];
  for (const [id, line, facts] of changes) {
    part(id).textContent = facts.join("; ");
    part(line).hidden = facts.length === 0;
  }
  part("changes").hidden = view.became_true.length + view.became_false.length === 0;
  for (const id of ["yes", "no"]) part(id).setAttribute("aria-disabled", view.phase !== "question");
  part("start").hidden = !mustStart();
  for (const command of view.commands) {
    const button = document.querySelector(`button[data-operator="${command.operator}"]`);
    button.setAttribute("aria-disabled", !command.is_possible);
    button.setAttribute("aria-pressed", command.is_present);
    const state = command.is_present ? main.dataset.ordered : command.is_possible ? "" : main.dataset.visited;
    button.querySelector(".state").textContent = state && `(${state})`;
    const room = document.querySelector(`[data-room="${command.object}"]`);
    if (room) room.classList.toggle("possible", command.is_possible);
  }
  if (view.phase === "question") shownAt = performance.now();
}

function sentence() {
  if (view.announced) return main.dataset.next.replace("{sentence}", view.announced);
  if (view.sentence) return view.phase === "waiting" ? `${view.sentence} ${main.dataset.waiting}` : view.sentence;
  return view.phase === "waiting" ? main.dataset.waiting : main.dataset.ready;
}

const mustStart = () => view.phase === "moving" && !hasStarted && !view.commands.some((c) => c.is_present);

function goOn() {
  clearTimeout(timer);
  if (view.phase === "moving" && !mustStart() && !isFinished) {
    timer = setTimeout(takeStep, 1000 * view.wait_s);
  }
}

function takeStep() {
  if (pending) return;
  const next = view.next;
  if (next) show({ ...view, ...next, number: view.number + next.num_taken });
  else send("/api/step", { number: view.number });
}

function finish() {
  clearTimeout(timer);
  if (changes) changes.close();
  for (const button of main.querySelectorAll(".panel button")) button.setAttribute("aria-disabled", true);
  part("start").hidden = true;
  part("finished").hidden = false;
  part("finished").querySelector("a").focus();
}

function answer(explicable) {
  if (view.phase !== "question" || pending || isFinished) return;
  send("/api/answer", { number: view.number, explicable, latency_s: (performance.now() - shownAt) / 1000 });
}

// Who clicks twice orders once: what is on its way, or in force, is not ordered again.
function command(found) {
  if (!found || !found.is_possible || isFinished || found.operator === ordered) return;
  if (found.is_present && view.phase !== "waiting") return;
  clearTimeout(timer);
  hasStarted = true;
  ordered = found.operator;
  send("/api/command", { operator: found.operator }).finally(() => { ordered = ""; });
}

part("yes").addEventListener("click", () => answer(true));
part("no").addEventListener("click", () => answer(false));
part("start").addEventListener("click", () => { hasStarted = true; draw(false); goOn(); part("yes").focus(); });
for (const button of document.querySelectorAll("button[data-operator]")) {
  button.addEventListener("click", () => command(view.commands.find((c) => c.operator === button.dataset.operator)));
}
part("picture").addEventListener("click", (event) => {
  const room = event.target.closest("[data-room]");
  if (room) command(view.commands.find((c) => c.object === room.dataset.room));
});
document.addEventListener("keydown", (event) => {
  if (!part("shortcuts").checked || event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
  const key = event.key.toLowerCase();
  if (key === "y" || key === "j") answer(true);
  else if (key === "n") answer(false);
  else if (/^[1-9]$/.test(key)) command(view.commands[Number(key) - 1]);
});

// Another tab may have gone on.
const changes = new EventSource("/api/changes");
changes.addEventListener("message", async (event) => {
  if (pending || isFinished || Number(event.data) <= view.revision) return;
  const response = await fetch("/api/view");
  if (response.ok && !pending) show(await response.json());
});

draw(false);
goOn();
