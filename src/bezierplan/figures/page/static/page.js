// Links into closed parts, tooltips by keyboard, search, filters, and tables that sort. Without this script the page shows the same content.
const find = (id) => document.getElementById(id);

// Libraries: their text is packed, and a blob makes a module of it, which a single file can import.

async function load(id) {
  const packed = Uint8Array.from(atob(find(id).textContent), (letter) => letter.charCodeAt(0));
  const text = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
  return import(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
}

// Tables

let library;

async function enhance(table) {
  library ??= load("page-tables");
  const { jQuery } = await library;
  const many = table.tBodies[0].rows.length > 8;
  jQuery(table).DataTable({
    paging: false, info: false, order: [], autoWidth: false, searching: many,
    layout: { topStart: many ? "search" : null, topEnd: null, bottomStart: null, bottomEnd: null },
    language: { search: "Filter rows" },
  });
}

function makeVisibleTablesSortable(root) {
  return Promise.all([...root.querySelectorAll("table.sortable")].filter((table) => table.offsetParent).map((table) => (table.made ??= enhance(table))));
}

document.addEventListener("toggle", (event) => {
  if (event.target.open) makeVisibleTablesSortable(event.target);
}, true);
makeVisibleTablesSortable(document);

// Addresses

function address() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return location.hash.slice(1);
  }
}

async function openAddress() {
  const place = find(address());
  if (!place) return;
  for (let part = place; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  // The library moves a table, which takes the focus away.
  await makeVisibleTablesSortable(place.closest("details") ?? place);
  for (const claims of place.closest(".claims")?.querySelectorAll("[aria-pressed=true]") ?? []) claims.click();
  const focus = place.querySelector("summary, a, [tabindex]") ?? place;
  focus.focus({ preventScroll: true });
  place.scrollIntoView({ block: place.tagName === "TD" ? "center" : "start", behavior: "instant" });
}

addEventListener("hashchange", openAddress);
openAddress();

addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details:not([open])")) {
    part.open = true;
    part.dataset.closed = "yes";
  }
});
addEventListener("afterprint", () => {
  for (const part of document.querySelectorAll("details[data-closed]")) {
    part.open = false;
    delete part.dataset.closed;
  }
});

// Tooltips: titles appear on hover only, so focus shows them as well.

const tip = find("page-tip");

function tipOf(cell) {
  if (cell.title) {
    cell.dataset.tip = cell.title;
    cell.removeAttribute("title");
  }
  return cell.dataset.tip;
}

function showTip(cell) {
  showWords(tipOf(cell), cell.getBoundingClientRect());
  cell.querySelector("a").setAttribute("aria-describedby", tip.id);
}

function showWords(words, place) {
  tip.replaceChildren(...words.split("; ").map((line) => Object.assign(document.createElement("div"), { textContent: line })));
  tip.hidden = false;
  const below = place.bottom + tip.offsetHeight + 8 < innerHeight;
  tip.style.left = `${Math.max(8, Math.min(place.left, innerWidth - tip.offsetWidth - 8))}px`;
  tip.style.top = `${below ? place.bottom + 4 : place.top - tip.offsetHeight - 4}px`;
}

for (const kind of ["mouseover", "focusin"]) {
  document.addEventListener(kind, (event) => {
    const cell = event.target.closest?.(".numbers td[title], .numbers td[data-tip]");
    if (cell) showTip(cell);
    else tip.hidden = true;
  });
}
document.addEventListener("focusout", () => { tip.hidden = true; });
document.addEventListener("keydown", (event) => { if (event.key === "Escape") tip.hidden = true; });
addEventListener("scroll", () => {
  const cell = document.activeElement.closest(".numbers td[data-tip]");
  if (cell) showTip(cell);
  else tip.hidden = true;
}, { passive: true });

// Charts: the library draws anew what stands there as a picture. A click on a mark leads to its number, method or paper.

async function drawCharts() {
  await load("page-vega");
  const specs = JSON.parse(find("page-charts").textContent);
  for (const place of document.querySelectorAll("[data-chart]")) {
    const stage = document.createElement("div");
    const picture = place.firstElementChild;
    place.append(stage);
    const tooltip = (handler, event, item, value) => {
      const words = item?.datum?.address && (item.datum.tip ?? tipOf(find(item.datum.address)));
      if (value && words) showWords(words, new DOMRect(event.clientX, event.clientY, 0, 12));
      else tip.hidden = true;
    };
    const { view } = await vegaEmbed(stage, specs[place.dataset.chart], { actions: false, defaultStyle: false, renderer: "svg", tooltip });
    view.addEventListener("click", (event, item) => { if (item?.datum?.address) location.hash = item.datum.address; });
    stage.chart = view;
    picture.remove();
  }
  chooseMethods();
}

function chooseMethods() {
  const form = document.querySelector(".toggles"), chart = document.querySelector("[data-chart=methods] > div")?.chart;
  if (!form) return;
  form.hidden = false;
  form.addEventListener("change", (event) => {
    const study = event.target.closest("fieldset"), boxes = [...study.querySelectorAll("[value]")];
    if ("all" in event.target.dataset) for (const box of boxes) box.checked = event.target.checked;
    else study.querySelector("[data-all]").checked = boxes.some((box) => box.checked);
    chart.signal("hidden", [...form.querySelectorAll("[value]:not(:checked)")].map((box) => box.value)).runAsync();
  });
}

if (find("page-vega")) drawCharts();

// Figures that enlarge

const enlarged = find("page-enlarged"), large = new Image();
enlarged.append(large);

for (const sheet of document.querySelectorAll(".sheet")) {
  sheet.addEventListener("click", (event) => {
    const { src, alt } = sheet.firstElementChild;
    Object.assign(large, { src, alt });
    enlarged.showModal();
    event.preventDefault();
  });
}
enlarged.addEventListener("click", (event) => { if (event.target === enlarged) enlarged.close(); });

// Commands and addresses that can be copied

function offer(button, text) {
  button.hidden = !navigator.clipboard;
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(text());
    button.textContent = "Copied";
  });
}

for (const button of document.querySelectorAll(".copy")) offer(button, () => find(button.dataset.copies).textContent);
for (const link of document.querySelectorAll(".here")) {
  const button = Object.assign(document.createElement("button"), { type: "button", className: "copy", textContent: "Copy the address" });
  link.after(" ", button);
  offer(button, () => link.href);
}

// Filters of claims by verdict

for (const filter of document.querySelectorAll(".filter")) {
  filter.hidden = false;
  filter.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const chosen = button.getAttribute("aria-pressed") !== "true";
    for (const each of filter.children) each.setAttribute("aria-pressed", String(each === button && chosen));
    for (const claim of filter.parentElement.querySelectorAll(".claim")) {
      claim.hidden = chosen && claim.dataset.verdict !== button.dataset.verdict;
    }
  });
}

// Search: entries in which most of the words begin a word of theirs; of these, first the ones whose shown text has the words themselves.

let index;
const EMPTY = new Set("a an and are by can did do does for how i in is it its me my of on or s should the to was were what which with".split(" "));
const wordsOf = (text) => text.toLowerCase().split(/[^\p{L}\p{N}-]+/u).filter(Boolean);
const query = find("page-query"), hits = find("page-hits"), found = find("page-found");

function search() {
  const words = wordsOf(query.value).filter((word) => !EMPTY.has(word));
  index ??= JSON.parse(find("page-index").textContent).map(([kind, address, text, more, later]) => (
    { kind, address, text, later, all: ` ${wordsOf(`${kind} ${address} ${text} ${more}`).join(" ")} `, own: ` ${wordsOf(text).join(" ")} ` }));
  const scored = index.map((each) => [words.filter((word) => each.all.includes(/^\d+$/.test(word) ? ` ${word} ` : ` ${word}`)).length, each]);
  const most = Math.max(...scored.map(([score]) => score));
  const matching = most ? scored.filter(([score]) => score === most).map(([, each]) => each) : [];
  const rank = (each) => (each.kind === "section" ? -1 : 0) + (each.kind === "word" && words.includes(wordsOf(each.text)[0]) ? -3 : 0) + (each.own.startsWith(` ${words.join(" ")} `) ? -3 : 0) + (each.later ? 2 : 0) + (words.every((word) => wordsOf(each.text).includes(word)) ? 0 : 1);
  const best = matching.map((each) => [rank(each), each]).sort((one, other) => one[0] - other[0]).slice(0, 30);
  hits.replaceChildren(...best.map(([, each]) => {
    const link = Object.assign(document.createElement("a"), { href: `#${encodeURI(each.address)}`, textContent: each.text });
    link.append(Object.assign(document.createElement("small"), { textContent: `${each.kind} · ${each.address}` }));
    const item = document.createElement("li");
    item.append(link);
    return item;
  }));
  hits.hidden = !best.length;
  found.textContent = words.length ? `${matching.length} found` : "";
}

function moveAmongHits(event) {
  const links = [...hits.querySelectorAll("a")];
  const at = links.indexOf(document.activeElement);
  if (event.key === "Escape") {
    hits.hidden = true;
    query.focus();
  } else if (event.key === "ArrowDown") links[Math.min(at + 1, links.length - 1)]?.focus();
  else if (event.key === "ArrowUp") (at > 0 ? links[at - 1] : query).focus();
  else if (event.key === "Enter" && event.target === query) links[0]?.click();
  else return;
  event.preventDefault();
}

document.querySelector(".search").hidden = false;
query.addEventListener("input", search);
query.addEventListener("focus", () => { if (query.value) search(); });
document.querySelector(".search").addEventListener("keydown", moveAmongHits);
hits.addEventListener("click", (event) => {
  const link = event.target.closest("a");
  if (link && link.hash === location.hash) openAddress();
  hits.hidden = true;
});
document.addEventListener("click", (event) => { if (!event.target.closest(".search")) hits.hidden = true; });
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && !event.target.closest("input, select, textarea")) {
    event.preventDefault();
    query.focus();
  }
});
