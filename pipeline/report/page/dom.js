"use strict";

// All content is created here: strings become text nodes, never markup.
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return node;
}

function svgElement(tag, attributes = {}, text = null) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text !== null) node.textContent = text;
  return node;
}

const color = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const known = (value) => typeof value === "number" && Number.isFinite(value);
const fixed = (value, digits) => (known(value) ? value.toFixed(digits) : "–");
const modelLabel = (name) => ({ random: "Random", without_touch: "w/o Touch", without_embedding: "w/o Embedding", full: "Full", hold: "Hold", damped: "Damped", median: "Median", linear: "Linear", truth: "truth", labels: "labels" })[name] || name;

// rows: arrays of cells; a cell is text or {text, kind: "number" | "best"}
function table(head, rows) {
  const cell = (tag, value) => {
    const { text, kind = "" } = typeof value === "object" ? value : { text: value };
    return element(tag, { class: kind === "best" ? "number best" : kind }, String(text));
  };
  return element("div", { class: "wide" }, element("table", {},
    element("thead", {}, element("tr", {}, head.map((value) => cell("th", value)))),
    element("tbody", {}, rows.map((row) => element("tr", row.group ? { class: "group" } : {}, row.cells.map((value) => cell("td", value)))))));
}

const number = (text) => ({ text, kind: "number" });

function legend(items) {
  return element("div", { class: "legend" }, items.map(({ name, stroke, dot, dash }) =>
    element("span", {}, element("i", dot ? { class: "dot", style: `background:var(--${stroke})` } : { style: `border-color:var(--${stroke});border-top-style:${dash ? "dashed" : "solid"}` }), name)));
}

function section(id, title, intro, ...children) {
  document.getElementById("main").append(element("section", { id }, element("h2", {}, title), intro ? element("p", {}, intro) : null, children));
  document.getElementById("contents").append(element("a", { href: "#" + id }, title));
}
