// The second run beside the first: its values at the nearest of its positions.
function besideAt(view, contact) {
  const beside = content.compared;
  if (!beside || !beside.cases.length || view.torque !== "full") return null;
  const name = `b/${view.second}/full/${contact.kind}/`;
  if (!has(name + "load")) return null;
  const [discs, count] = shapeOf(name + "load");
  if (view.disc >= discs || contact.number >= count) return null;
  const at = nearestAngle(row("b/angle"), row("angle")[view.index]);
  const value = quantity => row(name + quantity, view.disc, contact.number)[at];
  return { load: value("load"), pressure: value("pressure"), width: value("width") };
}
function nearestAngle(angles, angle) {
  const apart = other => { const turn = Math.abs(other - angle) % (2 * Math.PI); return Math.min(turn, 2 * Math.PI - turn); };
  let best = 0;
  for (let i = 1; i < angles.length; i++) if (apart(angles[i]) < apart(angles[best]) - 1e-9) best = i;
  return best;
}

// The largest load and pressure of a case at a torque: one scale for all its positions.
const scales = new Map();
function scaleOf(view) {
  const key = [view.kase, view.disc, view.torque, view.second].join();
  if (!scales.has(key)) {
    const most = (prefix, quantity) => Math.max(...["pin", "outer", "hole"].map(kind => {
      const name = `${prefix}${kind}/${quantity}`;
      if (!has(name)) return 0;
      const [first, ...shape] = content.places[name];
      let largest = 0;
      for (let i = first; i < first + shape.reduce((a, b) => a * b, 1); i++) if (numbers[i] > largest) largest = numbers[i];
      return largest;
    }));
    const own = `${view.kase}/${view.torque}/`, beside = view.torque === "full" && content.compared ? `b/${view.second}/full/` : null;
    const both = quantity => Math.max(most(own, quantity), beside ? most(beside, quantity) : 0);
    scales.set(key, { load: both("load"), pressure: both("pressure") });
  }
  return scales.get(key);
}

const torqueName = (view, torque) => `${torque} ${figure(content.cases[view.kase][torque === "full" ? "torque" : "light"])} N·m`;

function tipOf(view, contact) {
  const rows = [], add = (name, own, load, pressure, width) => rows.push([name, own, `${figure(load, load < 100 ? 1 : 0)} N`, known(pressure) ? `${figure(pressure, 0)} MPa` : "–", known(width) ? `${figure(1000 * width, 1)} µm` : "–"]);
  const many = contact.kind === "outer", first = content.compared ? "this run" : "";
  add(many ? "bore" : "", first, contact.load, contact.pressureValue, contact.width);
  if (many) {
    const inner = quantity => row(`${view.kase}/${view.torque}/inner/${quantity}`, view.disc, contact.number)[view.index];
    add("inner race", first, inner("load"), inner("pressure"), inner("width"));
  }
  const beside = besideAt(view, contact);
  if (beside) add(many ? "bore" : "", content.compared.name, beside.load, beside.pressure, beside.width);
  const lean = row => row.filter((text, i) => i > 1 || rows.some(each => each[i]));
  const head = html("b", {}, null, contact.name);
  return [head, smallTable(lean(["", "", "load", hasWidth(view) ? "mid pressure" : "pressure", "half-width"]), rows.map(lean)), ...smallAlong(view, contact)];
}

function fillContacts(view, now) {
  const table = el("contacts"), scale = content.compared && content.compared.cases.length;
  const head = ["contact", "load, N", hasWidth(view) ? "pressure at mid-width, MPa" : "pressure, MPa", "half-width, µm", ...(scale ? [`${content.compared.name}: load, N`, "pressure, MPa"] : [])];
  const rows = now.contacts.map(contact => {
    const beside = besideAt(view, contact);
    const cells = [[contact.load, 1], [contact.pressureValue, 1], [1000 * contact.width, 2], ...(scale ? [[beside && beside.load, 1], [beside && beside.pressure, 1]] : [])];
    return [contact.name, ...cells.map(([value, digits]) => ({ text: figure(value, digits), value: known(value) ? String(value) : "" }))];
  });
  const made = html("thead", {});
  const line = html("tr", {}, made);
  head.forEach(text => html("th", { scope: "col" }, line, text));
  const body = html("tbody", {});
  for (const each of rows) {
    const line = html("tr", {}, body);
    html("th", { scope: "row" }, line, each[0]);
    each.slice(1).forEach(cell => html("td", { "data-value": cell.value }, line, cell.text));
  }
  table.replaceChildren(made, body);
}

function fillLegend(view) {
  const legend = el("legend"), scale = scaleOf(view);
  legend.replaceChildren();
  const item = (kind, words) => { const each = html("span", { class: "item" }, legend); html("span", { class: `key ${kind}` }, each); each.append(words); };
  for (const kind of ["pin", "outer", "hole"]) if (shapeOf(`${view.kase}/full/${kind}/load`)[1]) item(`k-${kind}`, `${KINDS[kind]}s`);
  if (content.compared && content.compared.cases.length) item("k-second", `${content.compared.name}${view.torque === "full" ? "" : " (torque of the run only)"}`);
  const ring = ringScale(view);
  if (ring) item("k-ring", `ring of the wheel, its displacement × ${figure(ring, 0)}`);
  html("span", { class: "item" }, legend, `longest arrow ${figure(scale.load)} N`);
  if (scale.pressure > 0) {
    const each = html("span", { class: "item" }, legend, "pressure 0");
    const bar = html("span", { class: "scale", role: "img", "aria-label": "from the least to the largest" }, each);
    bar.style.background = `linear-gradient(90deg, ${steps().join(",")})`;
    each.append(`${figure(scale.pressure)} MPa`);
  }
}
