(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const FULL = data.models[0];
  const cases = Object.keys(data.drives);
  const largest = Math.max(...data.positions.flatMap(p => p.contacts.flatMap(c => data.models.map(m => c.models[m][0] || 0))));
  const view = { kase: cases[0], index: 0, model: data.models[1] };
  const number = figure;
  const of = kase => data.positions.filter(p => p.case === kase);
  const position = () => of(view.kase)[view.index];

  function change(value, reference) {
    if (value === null || reference === null || !reference) return "";
    const percent = 100 * (value / reference - 1);
    return (percent >= 0 ? "+" : "−") + Math.abs(percent).toFixed(Math.abs(percent) < 9.95 ? 1 : 0) + " %";
  }

  const drawing = new Drawing(el("picture"), { tell: (contact, event) => showTip(contactTable(contact), event), hide: hideTip, choose: () => {} });
  const kindOf = model => model.replace(" ", "-");
  function drawDrive() {
    const now = position(), arrows = view.model === FULL ? [[FULL, 5]] : [[FULL, 7.5], [view.model, 3.2]];
    const contacts = now.contacts.filter(contact => contact.kind !== "roller_inner").map(contact => ({
      ...contact, key: contact.name,
      label: `${contact.name}: ${arrows.map(([model]) => `${model} ${number(contact.models[model][0], 0)} N`).join(", ")}`,
      arrows: arrows.map(([model, width]) => ({ load: contact.models[model][0] || 0, kind: kindOf(model), width: width, model: model })),
    }));
    drawing.show(data.drives[view.kase], { ...now, contacts: contacts }, largest);
  }

  function contactTable(contact) {
    const reference = contact.models[FULL], table = html("table", {});
    const line = (cells, model) => {
      const row = html("tr", {}, table);
      cells.forEach((text, i) => html(i ? "td" : "th", i || !model ? {} : { class: `m-${kindOf(model)}` }, row, text));
    };
    line(["", "load", "to FE", "pressure", "half-width"]);
    for (const model of data.models) {
      const own = contact.models[model];
      line([model, `${number(own[0], own[0] < 100 ? 1 : 0)} N`, model === FULL ? "" : change(own[0], reference[0]), number(own[1], 0) + (own[1] === null ? "" : " MPa"), number(own[2], 1) + (own[2] === null ? "" : " µm")], model);
    }
    return [html("b", {}, null, contact.name), table];
  }

  function drawBars() {
    const svg = el("bars"), now = position(), list = now.contacts.filter(c => c.kind !== "roller_inner");
    const row = 12 * data.models.length / 2 + 12, width = 520, top = 22;
    const left = Math.max(108, 6.6 * Math.max(...list.map(c => c.name.length)));
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${top + list.length * row + 4}`);
    let x = left;
    for (const model of data.models) {
      node("rect", { x: x, y: 5, width: 10, height: 10, class: `bar m-${kindOf(model)}` }, svg);
      node("text", { x: x + 14, y: 14, "font-size": 12 }, svg, model);
      x += 30 + 7 * model.length;
    }
    list.forEach((contact, i) => {
      const y = top + i * row, group = node("g", { class: "contact" }, svg);
      node("rect", { x: 0, y: y, width: width, height: row, class: i % 2 ? "" : "band", fill: "none" }, group);
      node("text", { x: 2, y: y + row / 2 + 4, "font-size": 12.5 }, group, contact.name);
      data.models.forEach((model, k) => {
        const load = contact.models[model][0] || 0;
        node("rect", { x: left, y: y + 5 + 6.4 * k, width: (width - left - 62) * load / largest, height: 5.4, class: `bar m-${kindOf(model)}` }, group);
      });
      const full = contact.models[FULL][0] || 0;
      const end = Math.max(...data.models.map(model => contact.models[model][0] || 0));
      node("text", { x: left + (width - left - 62) * end / largest + 5, y: y + row / 2 + 4, "font-size": 12, class: "soft" }, group, number(full, full < 100 ? 1 : 0) + " N");
      group.addEventListener("mousemove", event => showTip(contactTable(contact), event));
      group.addEventListener("mouseleave", hideTip);
    });
  }

  function fillTable(table, head, rows) {
    const top = html("thead", {}), body = html("tbody", {}), line = html("tr", {}, top);
    head.forEach(text => html("th", { scope: "col" }, line, text));
    for (const [title, ...values] of rows) {
      const row = html("tr", {}, body);
      html("th", { scope: "row" }, row, title);
      for (const [value, digits] of values) html("td", { "data-value": known(value) ? value : "" }, row, number(value, digits));
    }
    table.replaceChildren(top, body);
  }
  function fillTables() {
    const now = position();
    fillTable(el("totals"), ["", ...data.models], now.totals.map(line => [line.title, ...data.models.map(m => [line.models[m], line.digits])]));
    fillTable(el("contacts"), ["contact", ...data.models.flatMap(m => [`${m}: N`, "MPa", "µm"])],
      now.contacts.map(c => [c.name, ...data.models.flatMap(m => c.models[m].map((v, i) => [v, i === 2 || v < 100 ? 1 : 0]))]));
  }

  function draw() {
    const list = of(view.kase);
    view.index = Math.min(view.index, list.length - 1);
    el("angle").max = list.length - 1;
    el("angle").value = view.index;
    el("angle").disabled = list.length < 2;
    const angle = position().angle;
    el("angle-text").textContent = `${number(angle * 180 / Math.PI, 2)}° = ${number(angle, 4)} rad`;
    el("angle").setAttribute("aria-valuetext", el("angle-text").textContent);
    el("chosen-name").textContent = view.model === FULL ? "" : view.model;
    document.querySelector(".key.chosen").hidden = view.model === FULL;
    document.querySelector(".key.chosen").className = `key chosen m-${kindOf(view.model)}`;
    press("cases", cases, cases.indexOf(view.kase), i => { view.kase = cases[i]; draw(); });
    press("models", data.models, data.models.indexOf(view.model), i => { view.model = data.models[i]; draw(); });
    hideTip();
    drawDrive();
    drawBars();
    fillTables();
  }
  for (const button of document.querySelectorAll("[data-svg]")) button.addEventListener("click", () => saveSvg(el("picture"), `drive_${view.kase}`));
  el("angle").addEventListener("input", event => { view.index = Number(event.target.value); draw(); });
  draw();
})();
