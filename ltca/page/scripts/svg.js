"use strict";
// Elements, numbers as text, and figures taken along as SVG.
const NS = "http://www.w3.org/2000/svg";
const el = id => document.getElementById(id);

function node(name, attributes, parent, text) {
  const made = document.createElementNS(NS, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.appendChild(made);
  return made;
}

function html(name, attributes, parent, text) {
  const made = document.createElement(name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.appendChild(made);
  return made;
}

const known = value => value !== null && value !== undefined && Number.isFinite(value);

function minus(text) { return text.replace(/(^|[^\w])-(?=\d)|e-(?=\d)/g, found => found.slice(0, -1) + "−"); }

function figure(value, digits) {
  if (!known(value)) return "–";
  const text = digits === undefined ? String(Math.abs(value) >= 1000 ? Math.round(value) : Number(value.toPrecision(4))) : value.toFixed(digits);
  return minus(/^-0(\.0*)?$/.test(text) ? text.slice(1) : text);
}

// Cividis, even to every eye: the further from the ground of the page, the more. On paper it is as on a light page.
const CIVIDIS = ["#fee838", "#e1cc55", "#c3b369", "#a59c74", "#8a8678", "#707173", "#575d6d", "#3b496c", "#123570", "#00224e"];
const DARK = "(prefers-color-scheme: dark)";
let printing = false;
const steps = () => (matchMedia(DARK).matches && !printing ? [...CIVIDIS].reverse() : CIVIDIS);
function shade(part) {
  const all = steps(), place = Math.max(0, Math.min(1, part)) * (all.length - 1), low = Math.min(all.length - 2, Math.floor(place));
  const mix = [1, 3, 5].map(at => {
    const [a, b] = [all[low], all[low + 1]].map(colour => parseInt(colour.slice(at, at + 2), 16));
    return Math.round(a + (b - a) * (place - low));
  });
  return `rgb(${mix.join(",")})`;
}

function say(text) { if (el("told")) el("told").textContent = text; }

function save(name, text, type) {
  const link = html("a", { href: URL.createObjectURL(new Blob([text], { type: type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  say(`${name} saved`);
}

// A copy that stands alone: what style sheets say is written into each element.
const STYLES = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "fill-rule", "font-size", "font-family", "font-weight", "text-anchor", "opacity"];
function svgText(svg) {
  const copy = svg.cloneNode(true), box = svg.viewBox.baseVal;
  const originals = [svg, ...svg.querySelectorAll("*")], copies = [copy, ...copy.querySelectorAll("*")];
  originals.forEach((original, i) => {
    const style = getComputedStyle(original);
    for (const name of STYLES) copies[i].setAttribute(name, style.getPropertyValue(name));
    for (const name of ["class", "style", "tabindex", "role"]) copies[i].removeAttribute(name);
  });
  copy.setAttribute("xmlns", NS);
  copy.setAttribute("width", box.width > 100 ? box.width : 800);
  copy.setAttribute("height", (box.width > 100 ? 1 : 800 / box.width) * box.height);
  const ground = node("rect", { x: box.x, y: box.y, width: box.width, height: box.height, fill: getComputedStyle(document.body).getPropertyValue("--paper").trim() });
  copy.insertBefore(ground, copy.firstChild);
  return '<?xml version="1.0" encoding="UTF-8"?>\n' + new XMLSerializer().serializeToString(copy) + "\n";
}
const fileName = text => text.replace(/[^\p{L}\p{N}._-]+/gu, "_").slice(0, 80) || "figure";
function saveSvg(svg, name) { save(`${fileName(name)}.svg`, svgText(svg), "image/svg+xml"); }
