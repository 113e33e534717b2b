// A closed curve through points: each piece a cubic whose ends run along the line between the neighbours.
function smooth(points) {
  const count = points.length, at = i => points[(i + count) % count];
  const pull = (i, by) => at(i).map((value, c) => value + by * (at(i + 1)[c] - at(i - 1)[c]) / 6).join(",");
  return `M${at(0)}` + points.map((_, i) => `C${pull(i, 1)} ${pull(i + 1, -1)} ${at(i + 1)}`).join("") + "Z";
}

// The drive as a picture: parts, and at each contact an arrow for every load and a spot for its pressure.
class Drawing {
  constructor(svg, answers) {
    this.svg = svg;
    this.answers = answers; // tell(contact, event), hide(), choose(contact), move(steps)
    this.contacts = new Map();
    this.scene = null;
    svg.addEventListener("keydown", event => {
      const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (!step || !event.target.closest(".contact")) return;
      event.preventDefault();
      const all = [...this.world.querySelectorAll(".contact")], now = all.indexOf(event.target.closest(".contact"));
      all[(now + step + all.length) % all.length].focus();
    });
  }

  build(scene, now) {
    this.scene = scene;
    this.contacts.clear();
    const reach = scene.reach, thin = (this.thin = reach / 400);
    this.svg.replaceChildren();
    this.svg.setAttribute("viewBox", [-reach, -reach, 2 * reach, 2 * reach].join(" "));
    const world = (this.world = node("g", { transform: "scale(1,-1)" }, this.svg));
    const circle = ([x, y, r]) => `M${x - r},${y}a${r},${r} 0 1,0 ${2 * r},0a${r},${r} 0 1,0 ${-2 * r},0Z`;
    this.ring = now.ring ? node("path", { class: "wheelring", "fill-rule": "evenodd", "stroke-width": thin }, world) : null;
    const outline = "M" + scene.outline.map(p => p.join(",")).join("L") + "Z";
    const openings = [...scene.bores, ...scene.holes].map(circle).join("");
    this.disc = node("path", { d: outline + openings, "fill-rule": "evenodd", class: "disc", "stroke-width": thin }, world);
    this.races = now.cranks.map(() => node("circle", { class: "race", r: scene.race, "stroke-width": thin }, world));
    const perCrank = now.rollers.length / now.cranks.length; // numbered in every bearing anew
    // Numbers of parts stand in them; of small ones outside, of as many as have room; of small rollers nowhere.
    const size = thin * Math.min(22, Math.max(14, 7200 / (this.svg.clientWidth || 560))); // of those outside, nine pixels on a phone
    this.parts = ["pins", "rollers", "shafts"].map(kind => {
      const small = now[kind].some(c => 1.1 * c[2] < 9 * thin), beside = small && kind === "pins";
      const apart = beside ? 2 * Math.PI * Math.hypot(...now.pins[0].slice(0, 2)) / now.pins.length : Infinity;
      const every = small && !beside ? Infinity : [1, 2, 5, 10, 20, 50].find(each => each * apart >= 2.4 * size) || 100;
      return now[kind].map((c, i) => ({
        ring: node("circle", { class: `part ${kind}`, r: c[2], "stroke-width": thin }, world),
        text: i % every === 0 && every < Infinity ? node("text", { class: "number", dy: "0.35em", "font-size": beside ? size : Math.min(1.1 * c[2], 15 * thin), transform: "scale(1,-1)" }, world, String(kind === "rollers" ? i % perCrank : i)) : null,
        away: beside ? c[2] + size : 0,
      }));
    });
    this.arms = now.cranks.map((crank, i) => ({
      arm: node("path", { class: "arm", "stroke-width": 2 * thin }, world),
      axis: node("circle", { class: "axis", r: 3 * thin }, world),
      text: now.cranks.length > 1 ? node("text", { class: "number", dy: "2em", "font-size": 13 * thin, transform: "scale(1,-1)" }, world, `crank ${i}`) : null,
    }));
    this.forces = node("g", {}, world);
  }

  // Parts at their places, contacts with arrows {load, kind, width, model} as long as their part of the largest load.
  show(scene, now, largest) {
    if (scene !== this.scene) this.build(scene, now);
    if (this.ring && now.ring) this.ring.setAttribute("d", now.ring.map(smooth).join(""));
    this.disc.setAttribute("transform", `translate(${now.disc[0]},${now.disc[1]}) rotate(${now.disc[2] * 180 / Math.PI})`);
    ["pins", "rollers", "shafts"].forEach((kind, k) => now[kind].forEach(([x, y], i) => {
      const part = this.parts[k][i], out = 1 + part.away / (Math.hypot(x, y) || 1);
      place(part.ring, { cx: x, cy: y });
      if (part.text) place(part.text, { x: x * out, y: -y * out });
    }));
    now.cranks.forEach(([axis, up, x, y], i) => {
      place(this.races[i], { cx: x, cy: y });
      place(this.arms[i].arm, { d: `M${axis},${up}L${x},${y}` });
      place(this.arms[i].axis, { cx: axis, cy: up });
      if (this.arms[i].text) place(this.arms[i].text, { x: x, y: -y });
    });
    const here = new Set(now.contacts.map(contact => contact.key));
    for (const [key, made] of this.contacts) if (!here.has(key)) { made.group.remove(); this.contacts.delete(key); }
    now.contacts.forEach(contact => this.contact(contact, largest));
    const all = [...this.contacts.values()], focused = all.find(made => made.group === document.activeElement);
    const entry = focused || all.find(made => made.contact.chosen) || all[0];
    all.forEach(made => made.group.setAttribute("tabindex", made === entry ? 0 : -1));
  }

  contact(contact, largest) {
    let made = this.contacts.get(contact.key);
    const thin = this.thin;
    if (!made) {
      const group = node("g", { class: "contact", role: "button" }, this.forces);
      made = { group: group, arrows: [] };
      this.contacts.set(contact.key, made);
      const tell = event => this.answers.tell(made.contact, event);
      for (const name of ["mouseenter", "mousemove", "focus"]) group.addEventListener(name, tell);
      group.addEventListener("click", event => { this.answers.choose(made.contact); tell(event); });
      group.addEventListener("keydown", event => { if (event.key === "Enter") this.answers.choose(made.contact); });
      for (const name of ["mouseleave", "blur"]) group.addEventListener(name, () => this.answers.hide());
      made.body = node("g", {}, group);
      made.spot = node("circle", { class: "spot", r: 4.5 * thin, "stroke-width": 0.8 * thin }, group);
      made.ring = node("circle", { class: "ring", r: 9 * thin, "stroke-width": 1.6 * thin }, group);
      node("circle", { class: "reach", fill: "transparent", r: 14 * thin }, group);
    }
    made.contact = contact;
    made.group.setAttribute("aria-label", contact.label || contact.name);
    made.group.classList.toggle("chosen", Boolean(contact.chosen));
    while (made.arrows.length > contact.arrows.length) made.arrows.pop().group.remove();
    contact.arrows.forEach((each, i) => {
      if (!made.arrows[i]) {
        const group = node("g", {}, made.body);
        made.arrows[i] = { group: group, shaft: node("path", { class: "shaft" }, group), head: node("path", { class: "head" }, group) };
      }
      const arrow = made.arrows[i], length = largest > 0 ? 0.3 * this.scene.reach * each.load / largest : 0;
      place(arrow.group, { class: `load k-${each.kind}`, "data-model": each.model, "data-contact": contact.name, "data-load": each.load });
      const [x, y] = contact.at, [u, v] = contact.to, width = each.width * thin, head = Math.min(2.6 * width, 0.6 * length), half = 1.2 * width;
      const bx = x + u * (length - head), by = y + v * (length - head);
      place(arrow.shaft, { d: length > 0 ? `M${x},${y}L${bx},${by}` : "", "stroke-width": width });
      place(arrow.head, { d: length > 0 ? `M${x + u * length},${y + v * length}L${bx - v * half},${by + u * half}L${bx + v * half},${by - u * half}Z` : "" });
    });
    for (const circle of made.group.querySelectorAll(":scope > circle")) place(circle, { cx: contact.at[0], cy: contact.at[1] });
    made.spot.style.fill = known(contact.pressure) ? shade(contact.pressure) : "var(--paper)";
  }
}
function place(element, attributes) { for (const key in attributes) element.setAttribute(key, attributes[key]); }

// Numbers of a contact beside the pointer, or beside the contact where the keyboard is.
function showTip(parts, event) {
  const tip = el("tip"), box = event.currentTarget.getBoundingClientRect();
  tip.replaceChildren(...parts);
  tip.hidden = false;
  const keys = event.type === "focus", x = keys ? box.right : event.clientX, y = keys ? box.bottom : event.clientY;
  const left = Math.max(8, Math.min(x + 14, document.documentElement.clientWidth - tip.offsetWidth - 8));
  tip.style.left = left + window.scrollX + "px";
  tip.style.top = (y + 16 + tip.offsetHeight > window.innerHeight ? Math.max(8, y - tip.offsetHeight - 12) : y + 16) + window.scrollY + "px";
}
function hideTip() { el("tip").hidden = true; }

function smallTable(head, rows) {
  const table = html("table", {});
  for (const row of head ? [head, ...rows] : rows) {
    const line = html("tr", {}, table);
    row.forEach((text, i) => html(i ? "td" : "th", {}, line, text));
  }
  return table;
}

// Buttons of which one is pressed; the focus stays where it is.
function press(container, names, current, choose) {
  const group = el(container);
  if (group.children.length !== names.length) group.replaceChildren(...names.map((name, i) => {
    const button = html("button", { type: "button" }, null, name);
    button.addEventListener("click", () => choose(i));
    return button;
  }));
  [...group.children].forEach((button, i) => { button.textContent = names[i]; button.setAttribute("aria-pressed", String(i === current)); });
}
