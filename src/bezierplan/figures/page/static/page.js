// Links into closed parts, search, filters, and tables that sort. Without this script the page shows the same content.
const find = (id) => document.getElementById(id);

// Tables that sort: by data-order, or else by what a cell shows; empty cells come last.

for (const heading of document.querySelectorAll("table.sortable thead th")) {
  const button = Object.assign(document.createElement("button"), { type: "button", className: "sort" });
  button.append(...heading.childNodes);
  heading.append(button);
}

const orderOf = (row, at) => (row.cells[at].dataset.order ?? row.cells[at].textContent).trim();

function compare(one, other) {
  const [a, b] = [parseFloat(one), parseFloat(other)];
  if (!one || !other) return !one - !other;
  return Number.isNaN(a) || Number.isNaN(b) ? one.localeCompare(other, "en", { numeric: true }) : a - b;
}

document.addEventListener("click", (event) => {
  const heading = event.target.closest(".sort")?.parentElement;
  if (!heading) return;
  const sign = heading.ariaSort === "ascending" ? -1 : 1, body = heading.closest("table").tBodies[0], at = heading.cellIndex;
  for (const each of heading.parentElement.cells) each.removeAttribute("aria-sort");
  heading.ariaSort = sign > 0 ? "ascending" : "descending";
  body.append(...[...body.rows].sort((one, other) => {
    const [a, b] = [orderOf(one, at), orderOf(other, at)];
    return a && b ? sign * compare(a, b) : compare(a, b);
  }));
});

// Addresses. What the script adds may move a page that opens at an address: until a reader acts, it goes there again.

let acted = false;
for (const kind of ["wheel", "pointerdown", "keydown", "touchstart"]) addEventListener(kind, () => { acted = true; }, { passive: true });

function address() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return location.hash.slice(1);
  }
}

function openAddress() {
  const place = find(address());
  if (!place) return;
  for (let part = place; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  for (const claims of place.closest(".claims")?.querySelectorAll("[aria-pressed=true]") ?? []) claims.click();
  const focus = place.querySelector("summary, a, [tabindex]") ?? place;
  focus.focus({ preventScroll: true });
  place.scrollIntoView({ block: ["TD", "TR", "DT"].includes(place.tagName) ? "center" : "start", behavior: "instant" });
}

function settle() {
  if (!acted) openAddress();
}

addEventListener("hashchange", openAddress);
addEventListener("load", () => setTimeout(settle));

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

// Figures that enlarge

const enlarged = find("page-enlarged"), large = new Image();
enlarged.querySelector(".scroll").append(large);

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
// An entry is an element with data-finds, its kind and further words that find it.

let index;
const EMPTY = new Set("a an and are by can did do does for how i in is it its me my of on or s should the to was were what which with".split(" "));
const LATER = ["method", "comparison", "assumption"];
const wordsOf = (text) => text.toLowerCase().split(/[^\p{L}\p{N}-]+/u).filter(Boolean);
const query = find("page-query"), hits = find("page-hits"), found = find("page-found");

function shownText(element, more) {
  if (element.tagName === "DT") return `${element.textContent.trim()}: ${element.nextElementSibling.textContent}`;
  if (["TD", "TR"].includes(element.tagName)) return more;
  if (element.tagName === "P") return element.textContent;
  const parts = [...element.querySelectorAll(":scope > summary > .id, :scope > summary > .statement, :scope > :is(h1, h2), :scope > figcaption > strong")];
  return [...parts.map((part) => part.textContent), element.tagName === "FIGURE" ? more : ""].join(" ");
}

function entriesOfPage() {
  return [...document.querySelectorAll("[data-finds]")].map((element) => {
    const [kind, ...rest] = element.dataset.finds.split(": "), more = rest.join(": ");
    return [kind, element.id, shownText(element, more), more, LATER.includes(kind)];
  });
}

function search() {
  const words = wordsOf(query.value).filter((word) => !EMPTY.has(word));
  index ??= entriesOfPage().map(([kind, address, text, more, later]) => (
    { kind, address, text, later, all: ` ${wordsOf(`${kind} ${address} ${text} ${more}`).join(" ")} `, own: ` ${wordsOf(text).join(" ")} ` }));
  const scored = index.map((each) => [words.filter((word) => each.all.includes(/^\d+$/.test(word) ? ` ${word} ` : ` ${word}`)).length, each]);
  const most = Math.max(...scored.map(([score]) => score));
  const matching = most ? scored.filter(([score]) => score === most).map(([, each]) => each) : [];
  const rank = (each) => (each.kind === "section" ? -1 : 0) + (each.kind === "word" && words.includes(wordsOf(each.text)[0]) ? -3 : 0) + (each.own.startsWith(` ${words.join(" ")} `) ? -3 : 0) + (each.later ? 2 : 0) + (words.every((word) => wordsOf(each.text).includes(word)) ? 0 : 3);
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

// Pictures, which are packed

async function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
}

for (const picture of document.querySelectorAll("[data-packed]")) {
  const text = await unpack(picture.dataset.packed);
  delete picture.dataset.packed;
  Object.assign(picture, { loading: "lazy", src: URL.createObjectURL(new Blob([text], { type: "image/svg+xml" })) });
}
settle();
