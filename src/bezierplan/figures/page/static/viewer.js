// The path viewer: choose a run, see it in its workspace; a drive plays.
// Packed text: data of the viewer, and pictures.
async function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
}

async function unpackPictures() {
  for (const picture of document.querySelectorAll("[data-packed]")) {
    const text = await unpack(picture.dataset.packed);
    delete picture.dataset.packed;
    Object.assign(picture, { loading: "lazy", src: URL.createObjectURL(new Blob([text], { type: "image/svg+xml" })) });
  }
}

const data = JSON.parse(await unpack(find("page-data").textContent));
unpacked = true;
if (query.value) search();
const form = document.getElementById("viewer");
const SVG = "http://www.w3.org/2000/svg";
const ALL = "all problems";

function draw(tag, attributes, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

// "M x y L x y ..." of a flat list x0, y0, x1, y1, ...; y points up in a workspace and down on a screen.
function line(flat) {
  let text = "";
  for (let n = 0; n < flat.length; n += 2) text += `${n ? "L" : "M"}${flat[n]} ${-flat[n + 1]}`;
  return text;
}

// Workspace and path

function obstacles(workspace) {
  const shapes = [];
  for (const [x, y, radius] of workspace.circles ?? []) shapes.push(draw("circle", { class: "obstacle", cx: x, cy: -y, r: radius }));
  for (const rings of workspace.obstacles ?? []) {
    shapes.push(draw("path", { class: "obstacle", "fill-rule": "evenodd", d: rings.map((ring) => `${line(ring.flat())}Z`).join("") }));
  }
  if (workspace.rows) shapes.unshift(draw("path", { class: "cells", d: cells(workspace) }));
  return shapes;
}

// Occupied cells, one rectangle for each stretch of a row; the first row is the top one.
function cells({ rows, cell, origin = [0, 0] }) {
  const [x0, y0] = origin;
  let text = "";
  rows.forEach((row, number) => {
    const top = y0 + (rows.length - number) * cell;
    for (const found of row.matchAll(/#+/g)) {
      text += `M${x0 + found.index * cell} ${-top}h${found[0].length * cell}v${cell}h${-found[0].length * cell}z`;
    }
  });
  return text;
}

// Circles at a time: uniform motion, with centres reflected at walls, to the whole step before and the one after, and straight between.
function movedCircles({ walls: [left, right, bottom, top], circles }, time) {
  const step = Math.floor(time);
  const fold = (at, low, width) => {
    const along = ((at - low) % (2 * width) + 2 * width) % (2 * width);
    return low + Math.min(along, 2 * width - along);
  };
  const between = (at, speed, low, high) => {
    const [before, after] = [step, step + 1].map((when) => fold(at + speed * when, low, high - low));
    return before + (time - step) * (after - before);
  };
  return circles.map(([x, y, u, v, radius]) => [between(x, u, left, right), between(y, v, bottom, top), radius]);
}

function workspaceAt({ workspace: name, world }, time) {
  const workspace = data.workspaces[name];
  if (world?.circles.length) return { ...workspace, circles: movedCircles(world, time) };
  if (!world) return workspace;
  const width = workspace.rows[0].length, all = [...workspace.rows.join("")];
  for (const number of world.changed.filter((_, n) => world.moments[n] <= time).flat()) all[number] = all[number] === "#" ? "." : "#";
  return { ...workspace, rows: workspace.rows.map((_, row) => all.slice(row * width, (row + 1) * width).join("")) };
}

// The path travelled until a time; of a run that is no drive, its path.
function wayUntil({ path, driven, steps }, time) {
  if (steps === null || time >= steps) return path;
  const step = Math.floor(time), share = (time - step) / (Math.min(step + 1, steps) - step);
  let left = driven[step] + share * (driven[step + 1] - driven[step]), n = 0;
  for (let piece; n + 3 < path.length && left > (piece = Math.hypot(path[n + 2] - path[n], path[n + 3] - path[n + 1])); n += 2) left -= piece;
  const [x, y, u = x, v = y] = path.slice(n, n + 4), part = left / (Math.hypot(u - x, v - y) || 1);
  return [...path.slice(0, n + 2), x + part * (u - x), y + part * (v - y)];
}

// A star of five points.
function star(x, y, radius) {
  const corners = Array.from({ length: 10 }, (_, n) => {
    const angle = Math.PI * (n / 5 - 0.5), reach = n % 2 ? 0.45 * radius : radius;
    return `${x + reach * Math.cos(angle)} ${y + reach * Math.sin(angle)}`;
  });
  return `M${corners.join("L")}Z`;
}

function drawMap(problem, run, time = Infinity) {
  const map = document.getElementById("viewer-map"), workspace = workspaceAt(problem, Math.min(time, run.steps ?? 0));
  const [left, right, bottom, top] = workspace.bounds, way = wayUntil(run, time);
  const size = Math.max(right - left, top - bottom), pad = 0.03 * size, mark = 0.011 * size;
  map.setAttribute("viewBox", [left - pad, -top - pad, right - left + 2 * pad, top - bottom + 2 * pad].join(" "));
  const [x, y] = problem.start, [u, v] = problem.target;
  const parts = [draw("rect", { class: "ground", x: left, y: -top, width: right - left, height: top - bottom }), ...obstacles(workspace)];
  if (run.control.length) parts.push(draw("path", { class: "control", d: line(run.control) }));
  if (way.length) parts.push(draw("path", { class: "path", d: line(way) }));
  if (problem.bound_path.length) parts.push(draw("path", { class: "bound", d: line(problem.bound_path) }));
  for (let n = 0; n < run.control.length; n += 2) {
    parts.push(draw("circle", { class: "point", cx: run.control[n], cy: -run.control[n + 1], r: 0.6 * mark }));
  }
  parts.push(draw("rect", { class: "end", x: x - mark, y: -y - mark, width: 2 * mark, height: 2 * mark }));
  parts.push(draw("path", { class: "end", d: star(u, -v, 1.7 * mark) }));
  if (run.steps !== null) parts.push(draw("circle", { class: "robot", cx: way.at(-2), cy: -way.at(-1), r: mark }));
  if (run.collision && (run.collision_step ?? 0) <= time) {
    const [p, q] = run.collision, arm = 1.2 * mark;
    parts.push(draw("path", { class: "hit", d: `M${p - arm} ${-q - arm}l${2 * arm} ${2 * arm}m0 ${-2 * arm}l${-2 * arm} ${2 * arm}` }));
  }
  map.replaceChildren(...parts);
}

// Time of a drive, whose state is that of the slider

const STEPS_A_SECOND = 12;
const [player, clock, play, step] = ["time", "clock", "play", "step"].map((name) => document.getElementById(`viewer-${name}`));
let drawn;

function showTime(time) {
  clock.value = time;
  step.textContent = `step ${Math.floor(time)} of ${Math.ceil(clock.max)}`;
  drawMap(drawn.problem, drawn.run, time < clock.max ? time : Infinity);
}

function setPlaying(plays) {
  play.textContent = plays ? "Pause" : "Play";
  play.dataset.since = plays ? performance.now() : "";
  if (plays) requestAnimationFrame(playOn);
}

function playOn(now) {
  if (!play.dataset.since) return;
  showTime(Math.min(clock.max, Number(clock.value) + Math.max(0, now - play.dataset.since) / 1000 * STEPS_A_SECOND));
  setPlaying(clock.value < Number(clock.max));
}

// Convergence and facts

function drawHistory(history) {
  const chart = document.getElementById("viewer-history");
  const [left, right, top, bottom] = [4, 396, 18, 132];
  chart.setAttribute("viewBox", "0 0 400 150");
  chart.replaceChildren();
  if (!history.length) return;
  const last = history.at(-1)[0] || 1, values = history.map(([, value]) => value);
  const low = Math.min(...values), high = Math.max(...values), span = high - low || 1;
  const x = (generation) => left + (right - left) * generation / last, y = (value) => bottom - (bottom - top) * (value - low) / span;
  const steps = history.map(([generation, value], n) => (n ? `H${x(generation)}V${y(value)}` : `M${x(generation)} ${y(value)}`)).join("");
  chart.append(draw("path", { d: steps }), draw("text", { x: left, y: 12 }, `first: ${number(high)}`),
    draw("text", { x: right, y: bottom - 6, "text-anchor": "end" }, `last: ${number(values.at(-1))}`),
    draw("text", { x: left, y: 147 }, "generation 0"), draw("text", { x: right, y: 147, "text-anchor": "end" }, String(last)));
}

const number = (value) => (value === null ? "–" : String(Number(value.toPrecision(5))));

// A number with its unit: 1 cell, 2.5 cells; abbreviations such as m have no plural.
const amount = (value, unit) => `${number(value)} ${unit}${["unit", "cell"].includes(unit) && value !== 1 ? "s" : ""}`;

function showFacts(id, run, problem) {
  const { unit } = data.workspaces[problem.workspace], drive = run.steps !== null;
  const gap = !run.feasible || !problem.bound ? "" : `, ${(100 * (run.length / problem.bound - 1)).toFixed(1)} % above the bound`;
  const facts = [
    ["Verdict", run.feasible ? "feasible by the certified check" : `not feasible: it ${run.collision ? "collides" : "does not arrive"}`],
    drive ? ["Drive", `${run.claimed ? "arrives" : "stops"} after ${number(run.steps)} steps` +
      (run.collision ? `; first collision at step ${number(run.collision_step)}` : "")] : ["Planner's own check", run.claimed ? "feasible" : "not feasible"],
    ["Length", run.length === null ? "no path" : `${amount(run.length, unit)}${gap}`],
    ["Exact shortest path", problem.bound === null ? "no free path" : amount(problem.bound, unit)],
    run.feasible ? ["Clearance", amount(run.clearance !== null && Math.abs(run.clearance) < 1e-6 ? 0 : run.clearance, unit)] : ["Collision depth", amount(run.depth, unit)],
    ["Curve", run.curve.replaceAll("_", " ") || "none"],
    ["Evaluations", `${run.evaluations.toLocaleString("en")}; stopped by: ${run.stop.replaceAll("_", " ")}`],
  ];
  document.getElementById("viewer-facts").replaceChildren(...facts.flatMap(([name, text]) => [
    Object.assign(document.createElement("dt"), { textContent: name }), Object.assign(document.createElement("dd"), { textContent: text }),
  ]));
  document.getElementById("viewer-hit").hidden = !run.collision;
  document.getElementById("viewer-history-caption").textContent = drive
    ? "Distance travelled plus length of the plan, at each replan" : "Best objective per generation";
  document.getElementById("viewer-command").textContent = `python -m bezierplan replay ${id}`;
  document.getElementById("viewer-link").href = `#${encodeURI(id)}`;
}

// Choices, each of which narrows those after it

const NAMES = ["study", "experiment", "problem", "method"];

const label = (study, name) => data.studies[study]?.labels[name] ?? name.replaceAll("_", " ");

function fill(select, options, wanted) {
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  if (options.some(([value]) => value === wanted)) select.value = wanted;
}

const shownOf = (study) => data.studies[study].shown.map((each) => ({ ...each, study, problem: each.problem || ALL }));

// Fill the choices from the given level on, keeping what is chosen where it still exists.
function narrow(wanted) {
  fill(form.study, Object.keys(data.studies).filter((key) => data.studies[key].shown.length).map((key) => [key, key]), wanted.study);
  let left = shownOf(form.study.value);
  for (const name of NAMES.slice(1)) {
    const options = [...new Set(left.map((each) => each[name]))].map((value) => [value, value === ALL ? ALL : label(form.study.value, value)]);
    fill(form[name], options, wanted[name]);
    left = left.filter((each) => each[name] === form[name].value);
  }
  const [shown] = left;
  const where = (id) => ` (${label(form.study.value, id.split("/")[2])})`;
  const named = [["best", "best"], ["median", "median"], ["worst", "worst feasible"]].filter(([which]) => shown[which]);
  fill(form.run, [...named.map(([which, words]) => [shown[which], words + where(shown[which])]),
    ...shown.failed.map((id, n) => [id, `failed ${n + 1}${where(id)}`])], wanted.run);
  document.getElementById("viewer-stage").hidden = false;
  document.getElementById("viewer-note").textContent = `${shown.feasible} of ${shown.count} ${shown.count === 1 ? "run is" : "runs are"} feasible` +
    `${shown.failed.length ? `; the worst are the failed ones, of which ${shown.failed.length} can be chosen` : ""}. Map: ${label(form.study.value, data.runs[form.run.value].problem.split("/").at(-1))}.`;
  const run = data.runs[form.run.value], problem = data.problems[run.problem];
  drawn = { problem, run };
  player.hidden = run.steps === null;
  clock.max = run.steps ?? 0;
  clock.step = clock.max / 100;
  setPlaying(false);
  showTime(clock.max);
  drawHistory(run.history);
  showFacts(form.run.value, run, problem);
}

const chosen = () => Object.fromEntries([...NAMES, "run"].map((name) => [name, form[name].value]));

function openRun() {
  const id = decodeURIComponent(location.hash.slice(1)), [study] = id.split("/");
  if (id in data.runs) {
    const home = shownOf(study).find((each) => [each.best, each.median, each.worst, ...each.failed].includes(id));
    narrow({ ...home, run: id });
    form.study.focus({ preventScroll: true });
    document.getElementById("page-paths").scrollIntoView({ behavior: "instant" });
  } else if (id.split("/").length === 5 && !document.getElementById(id)) {
    document.getElementById("viewer-note").textContent = `This page does not hold run ${id}; python -m bezierplan replay ${id} draws it.`;
    document.getElementById("viewer-stage").hidden = true;
    for (const select of form.querySelectorAll("select")) select.selectedIndex = -1;
    document.getElementById("page-paths").scrollIntoView({ behavior: "instant" });
  }
}

if (form) {
  form.hidden = false;
  narrow({});
  if (!acted) openRun();
  addEventListener("hashchange", openRun);
  form.addEventListener("change", (event) => { if (event.target !== clock) narrow(chosen()); });
  clock.addEventListener("input", () => showTime(Number(clock.value)));
  play.addEventListener("click", () => {
    if (Number(clock.value) >= clock.max) showTime(0);
    setPlaying(!play.dataset.since);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
}

settle();
unpackPictures();
