// Controls, curves and what they move.
const view = { kase: 0, disc: 0, torque: "full", index: 0, chosen: null, picked: false, second: 0 };
const plots = {};
let drawing = null, playing = 0, degrees = null;

// The wheel pin with the largest load is shown, until a contact is chosen.
function follow() {
  if (view.picked) return;
  const prefix = `${view.kase}/${view.torque}/pin/load`, count = shapeOf(prefix)[1], load = i => row(prefix, view.disc, i)[view.index];
  let largest = 0;
  for (let i = 1; i < count; i++) if (load(i) > load(largest)) largest = i;
  if (view.chosen && view.chosen.kind === "pin" && view.chosen.number === largest) return;
  view.chosen = { kind: "pin", number: largest };
  drawContactCurves();
}

function draw() {
  follow();
  const now = placesAt(view), scale = scaleOf(view), beside = content.compared && content.compared.cases.length && view.torque === "full";
  for (const contact of now.contacts) {
    const second = beside ? besideAt(view, contact) : null;
    contact.pressure = scale.pressure > 0 && known(contact.pressureValue) ? contact.pressureValue / scale.pressure : null;
    contact.arrows = [{ load: contact.load, kind: contact.kind, width: second ? 7.5 : 5, model: "first" }];
    if (second) contact.arrows.push({ load: second.load || 0, kind: "second", width: 2.6, model: "second" });
    contact.label = `${contact.name}: ${figure(contact.load, 0)} N, ${figure(contact.pressureValue, 0)} MPa${second ? `; ${content.compared.name} ${figure(second.load, 0)} N` : ""}`;
  }
  drawing.show(content.cases[view.kase].scenes[view.disc], now, scale.load);
  const degree = degrees[view.index];
  el("angle").value = view.index;
  el("angle-text").textContent = `${figure(degree, 2)}° = ${figure(row("angle")[view.index], 4)} rad${now.known ? "" : ", no answer here"}`;
  el("angle").setAttribute("aria-valuetext", el("angle-text").textContent);
  for (const name in plots) if (plots[name].spec.pick) plots[name].cursor(view.index);
  drawWidths(view);
  if (el("contact-details").open && !playing) fillContacts(view, now);
  return now;
}

function choose(contact) {
  const again = view.picked && view.chosen.kind === contact.kind && view.chosen.number === contact.number;
  view.picked = !again;
  view.chosen = again ? null : { kind: contact.kind, number: contact.number };
  if (!again) drawContactCurves();
  draw();
}

function drawContactCurves() {
  contactCurves("load", "Load", "N");
  contactCurves("pressure", "Pressure", "MPa");
  el("follow").textContent = view.picked ? "Follow the largest load" : "Follows the largest load";
  el("follow").setAttribute("aria-pressed", String(!view.picked));
}

function setUp() {
  const kase = content.cases[view.kase];
  if (el("cases")) press("cases", content.names, view.kase, i => { view.kase = i; if (content.compared) view.second = content.compared.match[i] || 0; setUp(); });
  const discs = Array.from({ length: content.discs }, (_, i) => `disc ${i}`);
  el("disc-field").hidden = discs.length < 2;
  press("discs", discs, view.disc, i => { view.disc = i; setUp(); });
  press("torques", (has("0/light/wheel") ? ["full", "light"] : ["full"]).map(each => torqueName(view, each)), view.torque === "full" ? 0 : 1, i => { view.torque = i ? "light" : "full"; setUp(); });
  const seconds = content.compared ? content.compared.cases : [];
  el("second-field").hidden = seconds.length < 2;
  press("seconds", seconds, view.second, i => { view.second = i; setUp(); });
  el("picture").setAttribute("data-direction", kase.direction);
  hideTip();
  fillLegend(view);
  drawCurves();
  draw();
}

function curve(id, where, title, unit, options, series) {
  if (!plots[id]) plots[id] = new Plot(el(where), { id: id, unit: unit, x: degrees, xTitle: "crank angle", degrees: true, pick: go, ...options });
  plots[id].spec.axis = options.axis;
  if (options.axis) plots[id].spec.digits = Math.max(0, Math.ceil(2 - Math.log10(options.axis[2])));
  plots[id].set(title, series);
}

function contactCurves(quantity, title, unit) {
  const { kind, number } = view.chosen, name = `${view.kase}/${view.torque}/${kind}/${quantity}`, series = [];
  const count = shapeOf(name)[1];
  // All of them are one line: it stands while the chosen one changes.
  const every = Array.from({ length: count }, (_, i) => row(name, view.disc, i));
  if (count > 1) series.push({ many: every, key: `${name}/${view.disc}`, values: every[0], colour: "c-faint", faint: true, name: `the other ${KINDS[kind]}s` });
  series.push({ values: row(name, view.disc, number), colour: `k-${kind}`, name: contactName(kind, number) });
  const second = `b/${view.second}/full/${kind}/${quantity}`;
  if (view.torque === "full" && has(second)) {
    const [discs, others] = shapeOf(second);
    if (view.disc < discs && number < others) series.push({ values: besideCurve(row(second, view.disc, number)), colour: "c-second", dashed: true, name: content.compared.name });
  }
  const of = content.discs > 1 ? `, disc ${view.disc}` : "";
  curve(quantity, "beside", `${title} at ${contactName(kind, number)}${of}`, unit, { zero: true, axis: content.axes[`${view.torque}/${kind}/${quantity}`] }, series);
}

// A curve of the second run at the positions of the first.
function besideCurve(values) {
  const angles = row("b/angle"), own = row("angle");
  if (angles.length === own.length && angles.every((angle, i) => Math.abs(angle - own[i]) < 1e-6)) return values;
  return Float32Array.from(own, angle => values[nearestAngle(angles, angle)]);
}

function drawCurves() {
  follow();
  const { kase, disc, torque } = view, beside = content.compared;
  drawContactCurves();
  const own = row(`${kase}/${torque}/te`);
  const errors = [{ values: deviation(own), colour: "c1", name: `${beside ? "this run, from" : "from"} its mean of ${figure(mean(own), 2)}″:` }];
  if (beside && beside.cases.length) {
    const other = row(`b/${view.second}/${torque}/te`);
    errors.push({ values: besideCurve(deviation(other)), colour: "c-second", dashed: true, name: `${beside.name}, from its mean of ${figure(mean(other), 2)}″:` });
  }
  if (has("b/measured/te")) errors.push(measured());
  curve("te", "curves", `Transmission error at ${torqueName(view, torque)}, deviation from the mean`, "arc seconds", { axis: content.axes[`${torque}/te`] }, errors);
  const cranks = shapeOf(`${kase}/radial`)[1], of = (name, crank) => row(`${kase}/${name}`, disc, crank);
  const total = crank => of("radial", crank).map((value, i) => Math.hypot(value, of("tangential", crank)[i]));
  for (const [name, words, values] of [["total", "Bearing load", total], ["tangential", "Tangential bearing load", crank => of("tangential", crank)], ["radial", "Radial bearing load", crank => of("radial", crank)]]) {
    const series = Array.from({ length: cranks }, (_, crank) => ({ values: values(crank), colour: `c${crank % 6 + 1}`, name: cranks > 1 ? `crank ${crank}` : "on the disc" }));
    curve(name, "curves", `${words}${content.discs > 1 ? `, disc ${disc}` : ""}, torque of the run`, "N", { axis: content.axes[name] }, series);
  }
  if (has(`${kase}/share`)) curve("share", "curves", "Part of the torque by disc", "", { axis: content.axes.share }, Array.from({ length: content.discs }, (_, i) => ({ values: row(`${kase}/share`, i), colour: `c${i % 6 + 1}`, name: `disc ${i}` })));
  if (has(`${kase}/crank`)) curve("crank", "curves", "Torque of each crank", "N·m", { axis: content.axes.crank }, Array.from({ length: content.cranks }, (_, i) => ({ values: row(`${kase}/crank`, i), colour: `c${i % 6 + 1}`, name: `crank ${i}` })));
  if (has(`${kase}/efficiency`)) {
    curve("efficiency", "curves", "Efficiency", "", { digits: 4 }, [{ values: row(`${kase}/efficiency`), colour: "c3", name: "" }]);
    const kinds = Object.keys(content.losses).filter(kind => has(`${kase}/loss/${kind}`));
    curve("loss", "curves", "Energy lost by radian of the crank", "N·mm", { zero: true, digits: 1 }, kinds.map((kind, i) => ({ values: row(`${kase}/loss/${kind}`), colour: `c${i % 6 + 1}`, name: content.losses[kind] })));
  }
  if (has(`${kase}/orders`)) {
    const lines = row(`${kase}/orders`), orders = Float32Array.from(lines, (_, i) => i + 1);
    if (!plots.orders) plots.orders = new Plot(el("orders-plot"), { id: "orders", unit: "arc seconds", x: orders, xTitle: "order, per turn of the crank", stems: true, zero: true, height: 200 });
    plots.orders.spec.x = orders;
    plots.orders.set(`Whole orders of the transmission error${content.names.length > 1 ? `, case ${content.names[kase]}` : ""}, amplitudes`, [{ values: lines, colour: "c1", name: "" }]);
  }
}

const mean = values => { const found = values.filter(known); return found.reduce((sum, value) => sum + value, 0) / found.length; };
const deviation = values => { const middle = mean(values); return values.map(value => value - middle); };
function measured() {
  return { values: deviation(row("b/measured/te")), x: Float32Array.from(row("b/measured/angle"), angle => angle * 180 / Math.PI), colour: "c2", thin: true, name: "measured, from its mean" };
}

function go(index) {
  const count = degrees.length;
  view.index = ((index % count) + count) % count;
  draw();
}

function play(on) {
  if (Boolean(playing) === on || degrees.length < 2) return;
  cancelAnimationFrame(playing);
  playing = 0;
  el("play").setAttribute("aria-pressed", String(on));
  el("play").textContent = on ? "❚❚ Pause" : "▶ Play";
  if (!on) { draw(); return; }
  const start = performance.now(), first = view.index, each = 9000 / degrees.length, sign = content.cases[view.kase].sign;
  const frame = time => {
    const index = first + sign * Math.floor(Math.max(0, time - start) / each);
    if (((index % degrees.length) + degrees.length) % degrees.length !== view.index) go(index);
    playing = requestAnimationFrame(frame);
  };
  playing = requestAnimationFrame(frame);
}

function listen() {
  el("angle").addEventListener("input", event => { play(false); go(Number(event.target.value)); });
  el("play").addEventListener("click", () => play(!playing));
  el("follow").addEventListener("click", () => { if (view.picked) choose(view.chosen); });
  el("contact-details").addEventListener("toggle", () => draw());
  for (const button of document.querySelectorAll("[data-svg]")) button.addEventListener("click", () => saveSvg(el(button.dataset.svg), `drive_${content.names[view.kase]}_${figure(degrees[view.index], 1)}deg`));
  document.addEventListener("keydown", event => {
    if (event.target.closest("input, select, textarea, button, summary, a, .wide") || event.altKey || event.ctrlKey || event.metaKey) return;
    const step = { ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
    const inStage = event.target.closest("#drive");
    if (step && (inStage || event.key.startsWith("Arrow"))) { play(false); go(view.index + step); event.preventDefault(); }
    if (event.key === " " && inStage) { play(!playing); event.preventDefault(); }
  });
  const recolour = () => { fillLegend(view); draw(); };
  matchMedia(DARK).addEventListener("change", recolour);
  for (const name of ["beforeprint", "afterprint"]) addEventListener(name, () => { printing = name === "beforeprint"; recolour(); });
  let width = innerWidth;
  const again = () => { for (const name in plots) plots[name].again(); drawWidths(view); };
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; again(); } });
}
