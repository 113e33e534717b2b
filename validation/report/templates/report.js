(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const NS = "http://www.w3.org/2000/svg";
  const FULL = data.models[0];
  const COLOURS = { "full FE": "#7b8794", "half-space": "#c2571a", "fe": "#1f5fa8", "hybrid": "#2a7d4f" };
  const cases = Object.keys(data.drives);
  const largest = Math.max(...data.positions.flatMap(p => p.contacts.flatMap(c => data.models.map(m => c.models[m][0] || 0))));
  const view = { kase: cases[0], index: 0, model: data.models[1] };
  const el = id => document.getElementById(id);
  const of = kase => data.positions.filter(p => p.case === kase);
  const position = () => of(view.kase)[view.index];

  function node(name, attributes, parent, text) {
    const made = document.createElementNS(NS, name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  }
  function number(value, digits) {
    if (value === null || value === undefined) return "–";
    const text = digits === undefined ? String(Math.abs(value) >= 100 ? Math.round(value) : Number(value.toPrecision(4))) : value.toFixed(digits);
    return text.replace("-", "−");
  }
  function change(value, reference) {
    if (value === null || reference === null || !reference) return "";
    const percent = 100 * (value / reference - 1);
    return (percent >= 0 ? "+" : "−") + Math.abs(percent).toFixed(Math.abs(percent) < 9.95 ? 1 : 0) + " %";
  }

  function drawDrive() {
    const svg = el("picture"), scene = data.drives[view.kase], now = position(), reach = scene.reach;
    svg.replaceChildren();
    svg.setAttribute("viewBox", [-reach, -reach, 2 * reach, 2 * reach].join(" "));
    const world = node("g", { transform: "scale(1,-1)" }, svg);
    const thin = reach / 400;
    const circle = (x, y, r) => `M${x - r},${y}a${r},${r} 0 1,0 ${2 * r},0a${r},${r} 0 1,0 ${-2 * r},0Z`;
    const outline = "M" + scene.outline.map(p => p.join(",")).join("L") + "Z";
    const openings = [...scene.bores, ...scene.holes].map(h => circle(h[0], h[1], h[2])).join("");
    const turn = now.disc[2] * 180 / Math.PI;
    node("path", { d: outline + openings, "fill-rule": "evenodd", fill: "#e6ecf2", stroke: "#8796a5", "stroke-width": thin, transform: `translate(${now.disc[0]},${now.disc[1]}) rotate(${turn})` }, world);
    for (const [, , x, y] of now.cranks)
      node("circle", { class: "race", cx: x, cy: y, r: scene.race, fill: "#f2f0ea", stroke: "#b3aa93", "stroke-width": thin }, world);
    const rollers = now.rollers.length / now.cranks.length; // numbered in every bearing anew
    for (const [list, fill, each] of [[now.pins, "#d7dde3"], [now.rollers, "#e9e3d3", rollers], [now.shafts, "#dbe5dc"]])
      list.forEach((c, i) => {
        node("circle", { cx: c[0], cy: c[1], r: c[2], fill: fill, stroke: "#97a3af", "stroke-width": thin }, world);
        node("text", { x: c[0], y: -c[1], dy: "0.35em", "font-size": Math.min(1.1 * c[2], 15 * thin), "text-anchor": "middle", fill: "#66727e", transform: "scale(1,-1)" }, world, String(each ? i % each : i));
      });
    now.cranks.forEach(([axis, up, x, y], i) => {
      node("path", { d: `M${axis},${up}L${x},${y}`, stroke: "#333", "stroke-width": 2 * thin }, world);
      node("circle", { cx: axis, cy: up, r: 3 * thin, fill: "#333" }, world);
      if (now.cranks.length > 1)
        node("text", { x: x, y: -y, dy: "2em", "font-size": 13 * thin, "text-anchor": "middle", fill: "#66727e", transform: "scale(1,-1)" }, world, `crank ${i}`);
    });
    const longest = 0.3 * reach;
    for (const contact of now.contacts) {
      if (contact.kind === "roller_inner") continue;
      const group = node("g", { class: "contact", tabindex: 0, role: "button", "aria-label": contact.name }, world);
      const arrows = view.model === FULL ? [[FULL, 5]] : [[FULL, 7.5], [view.model, 3.2]];
      for (const [model, width] of arrows) {
        const load = contact.models[model][0] || 0;
        arrow(group, contact, longest * load / largest, width * thin, COLOURS[model], { "data-model": model, "data-contact": contact.name, "data-load": load });
      }
      node("circle", { class: "spot", cx: contact.at[0], cy: contact.at[1], r: 4.5 * thin, fill: "#fff", stroke: "#333", "stroke-width": thin }, group);
      node("circle", { cx: contact.at[0], cy: contact.at[1], r: 16 * thin, fill: "transparent" }, group);
      const tell = event => showTip(contact, event);
      group.addEventListener("mouseenter", tell);
      group.addEventListener("mousemove", tell);
      group.addEventListener("focus", tell);
      group.addEventListener("click", tell);
      group.addEventListener("mouseleave", hideTip);
      group.addEventListener("blur", hideTip);
    }
  }
  function arrow(parent, contact, length, width, colour, attributes) {
    const [x, y] = contact.at, [u, v] = contact.to, head = Math.min(2.6 * width, 0.6 * length);
    if (length <= 0) { node("g", Object.assign({ class: "load" }, attributes), parent); return; }
    const bx = x + u * (length - head), by = y + v * (length - head), half = 1.2 * width;
    const group = node("g", Object.assign({ class: "load" }, attributes), parent);
    node("path", { d: `M${x},${y}L${bx},${by}`, stroke: colour, "stroke-width": width }, group);
    node("path", { d: `M${x + u * length},${y + v * length}L${bx - v * half},${by + u * half}L${bx + v * half},${by - u * half}Z`, fill: colour }, group);
  }

  function contactTable(contact) {
    const reference = contact.models[FULL];
    const lines = data.models.map(model => {
      const own = contact.models[model];
      return `<tr><th style="color:${COLOURS[model]}">${model}</th><td>${number(own[0], own[0] < 100 ? 1 : 0)} N</td><td>${model === FULL ? "" : change(own[0], reference[0])}</td><td>${number(own[1], 0)}${own[1] === null ? "" : " MPa"}</td><td>${number(own[2], 1)}${own[2] === null ? "" : " µm"}</td></tr>`;
    });
    return `<b>${contact.name}</b><table><tr><th></th><td>load</td><td>to FE</td><td>pressure</td><td>half-width</td></tr>${lines.join("")}</table>`;
  }
  function showTip(contact, event) {
    const tip = el("tip"), box = event.currentTarget.getBoundingClientRect();
    tip.innerHTML = contactTable(contact);
    tip.hidden = false;
    const x = event.type === "focus" ? box.right : event.clientX, y = event.type === "focus" ? box.bottom : event.clientY;
    const left = Math.max(8, Math.min(x + 14, document.documentElement.clientWidth - tip.offsetWidth - 8));
    tip.style.left = left + window.scrollX + "px";
    tip.style.top = (y + 16 + tip.offsetHeight > window.innerHeight ? Math.max(8, y - tip.offsetHeight - 12) : y + 16) + window.scrollY + "px";
  }
  function hideTip() { el("tip").hidden = true; }

  function drawBars() {
    const svg = el("bars"), now = position(), list = now.contacts.filter(c => c.kind !== "roller_inner");
    const row = 12 * data.models.length / 2 + 12, width = 520, top = 22;
    const left = Math.max(108, 6.6 * Math.max(...list.map(c => c.name.length)));
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${top + list.length * row + 4}`);
    let x = left;
    for (const model of data.models) {
      node("rect", { x: x, y: 5, width: 10, height: 10, fill: COLOURS[model] }, svg);
      node("text", { x: x + 14, y: 14, "font-size": 12, fill: "#1d2733" }, svg, model);
      x += 30 + 7 * model.length;
    }
    list.forEach((contact, i) => {
      const y = top + i * row, group = node("g", { class: "contact" }, svg);
      node("rect", { x: 0, y: y, width: width, height: row, fill: i % 2 ? "#fff" : "#f7f9fa" }, group);
      node("text", { x: 2, y: y + row / 2 + 4, "font-size": 12.5, fill: "#1d2733" }, group, contact.name);
      data.models.forEach((model, k) => {
        const load = contact.models[model][0] || 0;
        node("rect", { x: left, y: y + 5 + 6.4 * k, width: (width - left - 62) * load / largest, height: 5.4, fill: COLOURS[model] }, group);
      });
      const full = contact.models[FULL][0] || 0;
      const end = Math.max(...data.models.map(model => contact.models[model][0] || 0));
      node("text", { x: left + (width - left - 62) * end / largest + 5, y: y + row / 2 + 4, "font-size": 12, fill: "#5b6875" }, group, number(full, full < 100 ? 1 : 0) + " N");
      group.addEventListener("mousemove", event => showTip(contact, event));
      group.addEventListener("mouseleave", hideTip);
    });
  }

  function fillTables() {
    const now = position();
    const head = "<thead><tr><th></th>" + data.models.map(m => `<th>${m}</th>`).join("") + "</tr></thead>";
    el("totals").innerHTML = head + "<tbody>" + now.totals.map(line => `<tr><th scope="row">${line.title}</th>` + data.models.map(m => `<td>${number(line.models[m], line.digits)}</td>`).join("") + "</tr>").join("") + "</tbody>";
    el("contacts").innerHTML = "<thead><tr><th>contact</th>" + data.models.map(m => `<th>${m}: N</th><th>MPa</th><th>µm</th>`).join("") + "</tr></thead><tbody>" +
      now.contacts.map(c => `<tr><th scope="row">${c.name}</th>` + data.models.map(m => c.models[m].map((v, i) => `<td>${number(v, i === 2 || v < 100 ? 1 : 0)}</td>`).join("")).join("") + "</tr>").join("") + "</tbody>";
  }

  function press(container, names, current, choose) {
    el(container).replaceChildren(...names.map(name => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.setAttribute("aria-pressed", String(name === current));
      button.addEventListener("click", () => choose(name));
      return button;
    }));
  }
  function keepFocus(container, action) {
    const place = [...el(container).children].indexOf(document.activeElement);
    action();
    if (place >= 0) el(container).children[place].focus();
  }
  function draw() {
    const list = of(view.kase);
    view.index = Math.min(view.index, list.length - 1);
    el("angle").max = list.length - 1;
    el("angle").value = view.index;
    el("angle").disabled = list.length < 2;
    el("angle-text").textContent = position().angle.toPrecision(4) + " rad";
    el("angle").setAttribute("aria-valuetext", el("angle-text").textContent);
    el("chosen-name").textContent = view.model === FULL ? "" : view.model;
    document.querySelector(".key.chosen").hidden = view.model === FULL;
    document.documentElement.style.setProperty("--chosen", COLOURS[view.model]);
    press("cases", cases, view.kase, name => keepFocus("cases", () => { view.kase = name; draw(); }));
    press("models", data.models, view.model, name => keepFocus("models", () => { view.model = name; draw(); }));
    hideTip();
    drawDrive();
    drawBars();
    fillTables();
  }
  el("angle").addEventListener("input", event => { view.index = Number(event.target.value); draw(); });
  draw();
})();
