// The width of a contact in slices, line load as bars and pressure as a line, and the disc from the side with its tilt enlarged.
const WIDE = { width: 360, height: 170, left: 44, right: 48, top: 10, bottom: 30 }, SMALL = { width: 240, height: 92, left: 6, right: 6, top: 6, bottom: 6 };
const hasWidth = view => view.torque === "full" && has(`${view.kase}/full/pin/line`);

// The largest value of a kind of contacts over all positions: one scale for all of them.
const alongScales = new Map();
function largestAlong(name) {
  if (!alongScales.has(name)) {
    const [first, ...shape] = content.places[name];
    let largest = 0;
    for (let i = first; i < first + shape.reduce((a, b) => a * b, 1); i++) if (numbers[i] > largest) largest = numbers[i];
    alongScales.set(name, roundTop(largest || 1));
  }
  return alongScales.get(name);
}
const roundTop = value => { const power = 10 ** Math.floor(Math.log10(value)); return Math.ceil(5 * value / power - 1e-9) * power / 5; };
const wideBox = svg => ({ ...WIDE, width: Math.max(260, svg.clientWidth || WIDE.width) });

function alongWidth(view, kind, number) {
  const name = `${view.kase}/full/${kind}/`, count = shapeOf(name + "line")[2];
  const of = quantity => Array.from({ length: count }, (_, i) => row(name + quantity, view.disc, number, i)[view.index]);
  return { line: of("line"), pressure: of("along"), most: row(name + "most", view.disc, number)[view.index], length: content.cases[view.kase].widths[kind], mostLine: largestAlong(name + "line"), mostPressure: largestAlong(name + "along") };
}

function drawAlong(svg, view, kind, number, box) {
  const { line, pressure, length, mostLine, mostPressure } = alongWidth(view, kind, number), count = line.length;
  const inside = box.width - box.left - box.right, high = box.height - box.top - box.bottom, floor = box.top + high, each = inside / count;
  place(svg, { viewBox: `0 0 ${box.width} ${box.height}` });
  svg.replaceChildren();
  const x = z => box.left + (z / length + 0.5) * inside, labelled = box.bottom > 10;
  if (labelled) for (const part of [0, 0.5, 1]) {
    const y = floor - part * high;
    node("line", { class: "grid", x1: box.left, x2: box.left + inside, y1: y, y2: y }, svg);
    node("text", { class: "axis-text", x: box.left - 6, y: y + 4, "text-anchor": "end" }, svg, figure(part * mostLine, 0));
    node("text", { class: "axis-text", x: box.left + inside + 6, y: y + 4 }, svg, figure(part * mostPressure, 0));
  }
  line.forEach((value, i) => known(value) && node("rect", { class: `bar k-${kind}`, x: box.left + i * each + 0.5, width: each - 1, y: floor - high * value / mostLine, height: high * value / mostLine }, svg));
  const points = pressure.map((value, i) => `${box.left + (i + 0.5) * each},${floor - high * (known(value) ? value : 0) / mostPressure}`);
  node("polyline", { class: "curve along", points: points.join(" ") }, svg);
  node("line", { class: "floor", x1: box.left, x2: box.left + inside, y1: floor, y2: floor }, svg);
  if (!labelled) return;
  const ends = ticks(-0.5 * length, 0.5 * length, 5);
  for (const z of ends.found) node("text", { class: "axis-text", x: x(z), y: floor + 15, "text-anchor": "middle" }, svg, figure(z, ends.digits));
  node("text", { class: "axis-text", x: box.left + inside / 2, y: box.height - 2, "text-anchor": "middle" }, svg, "height above mid-width, mm");
}

// The largest pressure of a line, and beside it that of its ends, where it peaks within the last slice.
function pressureWords({ pressure, most }) {
  const middle = Math.max(...pressure);
  return `up to ${figure(middle, 0)} MPa${known(most) && most > 1.005 * middle ? `, ${figure(most, 0)} MPa at the very end` : ""}`;
}

// A small picture for the tip of a contact; none in the plane and at the light torque.
function smallAlong(view, contact) {
  if (!hasWidth(view)) return [];
  const svg = node("svg", { class: "small-width", width: SMALL.width, height: SMALL.height, role: "img", "aria-label": "line load and pressure along the width" });
  drawAlong(svg, view, contact.kind, contact.number, SMALL);
  const along = alongWidth(view, contact.kind, contact.number);
  return [svg, html("div", { class: "note" }, null, `along the width: line load (bars) up to ${figure(Math.max(...along.line), 0)} N/mm, pressure (line) ${pressureWords(along)}`)];
}

// How much larger a tilt is drawn: the largest of the case by some eight degrees, rounded.
const tiltScales = new Map();
function tiltScale(view) {
  if (!tiltScales.has(view.kase)) {
    const [first, discs, , count] = content.places[`${view.kase}/full/tilt`];
    let most = 0;
    for (let disc = 0; disc < discs; disc++) for (let i = 0; i < count; i++) {
      const at = first + 2 * disc * count + i, size = Math.hypot(numbers[at], numbers[at + count]);
      if (size > most) most = size;
    }
    const whole = most > 1e-9 ? 0.14 / most : 0, power = whole ? 10 ** Math.floor(Math.log10(whole)) : 0;
    tiltScales.set(view.kase, whole ? power * [5, 2, 1].find(part => part * power <= whole) : 0);
  }
  return tiltScales.get(view.kase);
}

// The disc from the side, in the plane in which it tilts: the axis lies across, the side to which its upper end goes is above.
function drawTilt(view) {
  const svg = el("tilt"), kase = content.cases[view.kase], thickness = kase.widths.pin, reach = Math.max(...kase.scenes[view.disc].outline.map(([x, y]) => Math.hypot(x, y)));
  const [about, beside] = [0, 1].map(axis => row(`${view.kase}/full/tilt`, view.disc, axis)[view.index]), tilt = Math.hypot(about, beside), scale = tiltScale(view);
  const { width, height } = wideBox(svg);
  place(svg, { viewBox: `0 0 ${width} ${height}` });
  svg.replaceChildren();
  const unit = 0.5 * (height - 24) / reach, cx = width / 2, cy = height / 2, turn = -scale * tilt * 180 / Math.PI;
  const half = [Math.max(unit * thickness / 2, 4), unit * reach], axis = Math.min(width / 2 - 30, 190);
  node("line", { class: "axis-line", x1: cx - axis, x2: cx + axis, y1: cy, y2: cy }, svg);
  const shape = { x: cx - half[0], y: cy - half[1], width: 2 * half[0], height: 2 * half[1] };
  node("rect", { ...shape, class: "straight" }, svg);
  const group = node("g", { transform: `rotate(${known(tilt) ? turn : 0} ${cx} ${cy})` }, svg);
  node("rect", { ...shape, class: "disc" }, group);
  node("line", { class: "axis-line tilted", x1: cx - axis, x2: cx + axis, y1: cy, y2: cy }, group);
  node("text", { class: "axis-text", x: cx + axis, y: height - 4, "text-anchor": "end" }, svg, "z →");
  const direction = Math.atan2(-about, beside) * 180 / Math.PI; // of the upper end of its axis
  el("tilt-keys").textContent = !known(tilt) ? "no answer here" : !scale ? "it does not tilt" :
    `${figure(1000 * tilt, 3)} mrad, rim ±${figure(1000 * tilt * reach, 1)} µm${kase.widths.play ? ` of ±${figure(500 * kase.widths.play, 1)} µm axial play` : ""}; drawn × ${figure(scale, 0)}, seen in the plane in which it tilts (${figure(direction, 0)}°)`;
  place(svg, { "aria-label": el("tilt-keys").textContent });
}

// Both pictures, of the contact that is chosen.
function drawWidths(view) {
  if (!el("widths")) return;
  el("widths").hidden = !hasWidth(view);
  if (el("widths").hidden) return;
  const { kind, number } = view.chosen, of = content.discs > 1 ? `, disc ${view.disc}` : "";
  el("width-title").textContent = `Along the width of ${contactName(kind, number)}${kind === "outer" ? " in the bore" : ""}${of}: line load, N/mm, and pressure, MPa`;
  drawAlong(el("width"), view, kind, number, wideBox(el("width")));
  const along = alongWidth(view, kind, number), { line, length } = along, mean = line.reduce((sum, value) => sum + value, 0) / line.length;
  const most = line.indexOf(Math.max(...line)), z = ((most + 0.5) / line.length - 0.5) * length;
  el("width-keys").textContent = mean > 0 ? `bars: line load, up to ${figure(line[most], 0)} N/mm at ${figure(z, 2)} mm, ${figure(line[most] / mean, 2)} times its mean; line: pressure, ${pressureWords(along)}` : "it is open here";
  place(el("width"), { "aria-label": `${el("width-title").textContent}; ${el("width-keys").textContent}` });
  el("tilt-title").textContent = `${content.discs > 1 ? `Disc ${view.disc}` : "The disc"} from the side, its tilt enlarged`;
  drawTilt(view);
}
