// Fields of the drive file by its sections, from the declaration of the program, and those that people turn with a slider.
const inputs = new Map(); // path -> every input of it
const fieldsByPath = new Map(); // what is declared of it

// A path may break behind its signs alone.
function breakable(parent, path) { for (const part of path.split(/(?<=[_.])/)) parent.append(part, document.createElement("wbr")); }

let rowsMade = 0; // of entries: names of theirs differ by signs that an id is without
function fieldRow(declared, path, parent, slider) {
  const id = declared.row ? `row-${++rowsMade}` : (slider ? "turn-" : "field-") + path.replace(/[^a-z0-9]/gi, "-");
  const box = html("div", { class: "row", "data-path": path }, parent), head = html("div", { class: "line" }, box);
  breakable(html("label", { for: id }, head), slider ? path : declared.name);
  let input;
  if (declared.choices.length && !declared.array) {
    input = html("select", { id: id }, head);
    html("option", { value: "" }, input, declared.required ? "–" : declared.default && declared.default !== "left out" ? `left out: ${declared.default}` : "left out");
    for (const choice of declared.choices) html("option", { value: choice }, input, choice);
  } else {
    input = html("input", { id: id, type: "text", autocomplete: "off", spellcheck: "false", placeholder: declared.required ? "needed" : declared.default }, head);
    if (declared.kind === "count") input.inputMode = "numeric";
  }
  html("span", { class: "unit" }, head, declared.unit);
  if (declared.kind === "quantity" && !declared.array && !declared.row) {
    const button = html("button", { type: "button", class: "tool", "aria-label": `What ${path} drives` }, head, "∂");
    button.title = "What it drives: how results follow a small change of it";
    button.addEventListener("click", () => askDerivative(path));
  }
  let range = null;
  if (slider) {
    range = html("input", { type: "range", "aria-label": `${path}, slider` }, box);
    range.addEventListener("input", () => { input.value = range.value + range.dataset.unit; change(path, input.value); });
    range.addEventListener("change", () => showFields());
  }
  const message = html("p", { class: "message", id: id + "-message", hidden: "" }, box);
  if (!slider) {
    const told = [declared.meaning, declared.bounds && `Must be ${declared.bounds}${declared.unit && !declared.bounds.includes("one") ? " " + declared.unit : ""}.`, declared.array ? "Several, divided by commas." : ""];
    html("p", { class: "meaning", id: id + "-meaning" }, box, told.filter(Boolean).join(" "));
    for (const line of declared.refused) html("p", { class: "meaning refused" }, box, line);
  } else html("p", { class: "meaning", id: id + "-meaning" }, box, declared.meaning);
  place(input, { "aria-describedby": `${id}-message ${id}-meaning` });
  input.addEventListener(input.tagName === "SELECT" ? "change" : "input", () => change(path, input.value));
  if (!inputs.has(path)) inputs.set(path, []);
  inputs.get(path).push({ input: input, range: range, message: message, box: box, declared: declared, turned: slider });
}

// Ends and step of a slider about a value: even decimals, some two hundred steps.
function rangeOf(path, value) {
  const [how, part] = first.declared.turned[path];
  const radius = Number(state.values["pin_wheel.pin_circle_radius"]) || 100;
  const half = how === "part" ? part * Math.abs(value) : part * radius, whole = how === "above" ? half : 2 * half;
  const raw = whole / first.declared.steps || 1e-6, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].map(each => each * power).find(each => each >= raw * 0.999);
  const low = how === "above" ? 0 : Math.round((value - half) / step) * step, count = Math.round(whole / step);
  return { low: low, high: low + count * step, step: step, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function tableName(path) { return path ? `[${path}]` : "head of the file"; }

function buildFields() {
  const turned = el("turned"), all = el("sections");
  for (const table of Object.values(first.declared.tables)) for (const field of table.fields) fieldsByPath.set(field.path, field);
  for (const path of Object.keys(first.declared.turned)) fieldRow(fieldsByPath.get(path), path, turned, true);
  for (const [path, table] of Object.entries(first.declared.tables)) {
    const box = html("details", { class: "section", "data-table": path }, all);
    const summary = html("summary", {}, box), title = html("span", { class: "table-name" }, summary, tableName(path));
    html("span", { class: "count" }, summary);
    title.title = table.meaning;
    const inside = html("div", { class: "fields" }, box);
    if (table.meaning) html("p", { class: "meaning" }, inside, table.meaning + (table.optional ? " May be left out." : ""));
    box.addEventListener("toggle", () => { if (box.open) { fillSection(box, path, table); showFields(); showProblems(problemsTold); } });
  }
}

function takeAway(entry) {
  for (const row of entry.querySelectorAll(".row")) inputs.set(row.dataset.path, (inputs.get(row.dataset.path) || []).filter(each => each.box !== row));
  entry.remove();
}

// What an entry is called, and the way to take it away.
function entryHead(entry, title, path) {
  const head = html("div", { class: "entry-head" }, entry);
  html("h4", {}, head, title);
  if (path) html("button", { type: "button", class: "tool", "aria-label": `Remove ${title}` }, head, "Remove").addEventListener("click", () => {
    entry.closest("details").querySelector("summary").focus(); // the button goes, and the focus with it
    changeEntries(`${path} taken away`, { remove: path });
  });
}

// Limits, tolerances, cases, bearings: entries have names, and are made anew when these are others.
function buildNamed() {
  for (const [table, declared] of Object.entries(first.named)) {
    const box = html("details", { class: "section named", "data-named": table }, el("named"));
    const summary = html("summary", {}, box);
    html("span", { class: "table-name", title: declared.meaning }, summary, table === "case" ? "[[case]]" : table === "bearings" ? "[bearings.NAME]" : `[${table}]`);
    html("span", { class: "count" }, summary);
    const inside = html("div", { class: "fields" }, box);
    html("p", { class: "meaning" }, inside, declared.meaning);
    html("div", { class: "entries" }, inside);
    adder(inside, table, declared, "Add");
    box.addEventListener("toggle", () => { if (box.open) { fillNamed(box); showFields(); showProblems(problemsTold); } });
    box.addEventListener("focusout", () => setTimeout(() => { if (box.open && !box.contains(document.activeElement)) { fillNamed(box); showFields(); } }, 0));
  }
}

// A name, what the entry cannot be without, and the button that adds it.
function adder(parent, table, declared, word) {
  const line = html("div", { class: "adder" }, parent), id = `add-${table.replace(".", "-")}`, keys = declared.keys.length ? { list: `${id}-names` } : {};
  const labelled = (label, name, more) => { const box = html("div", { class: "field" }, line); html("label", { for: `${id}-${name}` }, box, label); return html("input", { id: `${id}-${name}`, type: "text", autocomplete: "off", spellcheck: "false", ...more }, box); };
  const key = labelled(declared.key, "key", keys), value = declared.value ? labelled(declared.value, "value", {}) : null;
  if (declared.keys.length) { const names = html("datalist", { id: `${id}-names` }, line); for (const name of declared.keys) html("option", { value: name }, names); }
  const button = html("button", { type: "button", class: "add", "aria-label": `${word} to ${table}` }, line, word), message = html("p", { class: "message", role: "status", hidden: "" }, parent);
  const tell = text => { message.hidden = !text; message.textContent = text; };
  const add = () => changeEntries(`${table}: ${key.value}`, { entry: table, key: key.value, value: value ? value.value : "" }, problems => {
    tell(problems.map(problem => problem.text).join(" "));
    if (!problems.length) { key.value = ""; if (value) value.value = ""; }
  });
  button.addEventListener("click", add);
  for (const input of [key, value]) if (input) { input.addEventListener("input", () => tell("")); input.addEventListener("keydown", event => { if (event.key === "Enter") add(); }); }
}

function fillNamed(box) {
  const table = box.dataset.named, entries = state.named[table] || [], made = JSON.stringify(entries);
  if (box.dataset.made === made) return;
  const focus = document.activeElement, typing = focus && box.querySelector(".entries").contains(focus) && focus.tagName !== "BUTTON";
  if (typing && focus.closest(".row")) return; // what is being typed in stays, until it is left
  for (const old of box.querySelectorAll(".entries > .entry")) takeAway(old);
  for (const each of entries) {
    const entry = html("div", { class: "entry" }, box.querySelector(".entries"));
    entryHead(entry, each.title, each.path);
    for (const field of each.fields) fieldRow(field, field.path, entry, false);
    if (table === "case") adder(entry, each.path, first.named.case.own, "Give it");
  }
  box.dataset.made = made;
}

// Rows of a section, made when it is opened; those of entries as many times as there are entries.
function fillSection(box, path, table) {
  const inside = box.querySelector(".fields"), list = path.includes(".N") ? path.slice(0, path.indexOf(".N")) : "";
  const count = list ? state.entries[list] || 0 : 1;
  if (box.dataset.count === String(count)) return;
  for (const old of inside.querySelectorAll(".entry")) takeAway(old);
  for (let number = 0; number < count; number++) {
    const entry = html("div", { class: "entry" }, inside);
    if (list) entryHead(entry, `${list}, entry ${number}`, path === `${list}.N` ? `${list}.${number}` : "");
    for (const field of table.fields) fieldRow(field, field.path.replace(".N.", `.${number}.`), entry, false);
  }
  if (list && path === `${list}.N` && !inside.querySelector(".add")) html("button", { type: "button", class: "add" }, inside, `Add an entry of ${list}`).addEventListener("click", () => changeEntries("a further " + list, { entry: list }));
  box.dataset.count = String(count);
}

// Values as the text has them; what is being typed stays.
function showFields() {
  for (const box of document.querySelectorAll("#named details")) {
    const count = (state.named[box.dataset.named] || []).length;
    if (box.open) fillNamed(box);
    box.querySelector(".count").textContent = count ? `${count} given` : "";
    box.classList.toggle("given", count > 0);
  }
  for (const box of document.querySelectorAll("#sections details")) {
    const path = box.dataset.table, table = first.declared.tables[path];
    const list = path.includes(".N") ? path.slice(0, path.indexOf(".N")) : "";
    if (box.open) fillSection(box, path, table);
    const names = new Set(table.fields.map(field => field.path));
    const given = Object.keys(state.values).filter(name => names.has(name.replace(/\.\d+(?=\.|$)/g, ".N"))).length;
    box.querySelector(".count").textContent = list && path === `${list}.N` ? `${state.entries[list] || 0} entries` : given ? `${given} given` : "";
    box.classList.toggle("given", given > 0);
  }
  for (const [path, all] of inputs) for (const { input, range, box } of all) {
    const value = state.values[path] === undefined ? "" : state.values[path];
    if (document.activeElement !== input && !queue.some(each => each.changes && path in each.changes)) {
      if (input.tagName === "SELECT" && value && ![...input.options].some(option => option.value === value)) html("option", { value: value }, input, value);
      input.value = value;
    }
    box.classList.toggle("own", state.own.has(path));
    box.dataset.own = state.own.has(path) ? `of case ${state.case}` : "";
    if (range && document.activeElement !== range) {
      const [, written, unit] = value.match(/^\s*([+-]?[\d.]+(?:e[+-]?\d+)?)(\s*\S.*)?$/i) || ["", value === "" ? "0" : value, ""];
      const number = Number(written);
      range.disabled = !Number.isFinite(number);
      range.dataset.unit = unit || ""; // a number keeps the unit that it is written in
      if (range.disabled) continue;
      if (!(number > Number(range.min) && number < Number(range.max)) || !range.dataset.made || (number === 0) !== (range.dataset.zero === "yes")) {
        const ends = rangeOf(path, number || (path === "load.torque" ? 1000 : 0));
        place(range, { "data-made": "yes", min: ends.low.toFixed(ends.digits), max: ends.high.toFixed(ends.digits), step: ends.step.toFixed(ends.digits + 1), "data-zero": number === 0 ? "yes" : "no" });
      }
      range.value = number;
    }
  }
  if (document.activeElement !== el("text")) el("text").value = state.text;
}

// A message is of what was typed before: it goes with the next edit of its field.
function clearMessage(path) {
  problemsTold = problemsTold.map(problem => ({ ...problem, fields: problem.fields.filter(name => name !== path) }));
  for (const { input, message } of inputs.get(path) || []) {
    message.hidden = true;
    message.textContent = "";
    input.removeAttribute("aria-invalid");
  }
}

// Mistakes beside their fields; above, those of fields that are not the one just changed.
let problemsTold = []; // a section that is opened later shows them too
function showProblems(problems) {
  problemsTold = problems;
  const told = new Map();
  for (const problem of problems) for (const path of problem.fields) told.set(path, [...(told.get(path) || []), problem.text]);
  const of = path => [...told].filter(([name]) => name === path || name === path.replace(/\.(like|value|distribution)$/, "")).flatMap(([, words]) => words);
  const ofCase = declared => problems.filter(problem => problem.cases.includes(declared.case) && problem.fields.includes(declared.of)).map(problem => problem.text);
  for (const [path, all] of inputs) for (const { input, message, declared } of all) {
    const words = declared.case ? ofCase(declared) : of(path);
    message.hidden = !words.length;
    message.textContent = words.join(" ");
    if (words.length) input.setAttribute("aria-invalid", "true"); else input.removeAttribute("aria-invalid");
  }
  for (const box of document.querySelectorAll("#sections details")) {
    const path = box.dataset.table;
    box.classList.toggle("wrong", first.declared.tables[path].fields.some(field => of(field.path).length));
  }
  for (const box of document.querySelectorAll("#named details")) box.classList.toggle("wrong", problems.some(problem => problem.fields.some(path => path.startsWith(`${box.dataset.named}.`))));
  const others = problems.filter(problem => !problem.fields.some(path => path in first.declared.turned && (path === changed.what || !(changed.what in first.declared.turned)))); // those have it beside them
  el("problems").replaceChildren(...others.map(problem => html("li", {}, null, problem.text)));
  el("problems").hidden = !others.length;
}

function search() {
  const wanted = el("find").value.trim().toLowerCase().split(/\s+/).filter(Boolean);
  for (const box of document.querySelectorAll("#sections details")) {
    const path = box.dataset.table, table = first.declared.tables[path];
    const hit = table.fields.filter(field => wanted.every(word => `${field.path} ${field.meaning}`.toLowerCase().includes(word)));
    box.hidden = wanted.length > 0 && !hit.length;
    if (wanted.length && hit.length && hit.length < 12) box.open = true;
  }
  for (const box of document.querySelectorAll("#named details")) {
    const table = box.dataset.named, words = [table, first.named[table].meaning, ...first.named[table].keys, ...(state.named[table] || []).map(each => each.title)];
    box.hidden = !words.some(text => wanted.every(word => text.toLowerCase().includes(word)));
  }
}
