// Answers of the server: asked for as the text changes, shown whole and in one go, those of an older text greyed.
let asked = null, again = 0, coarseAt = 0, shown = null;
const fineAnswers = new Map(); // of variants, by what was asked
const derived = { sequence: -1, extra: [], rows: new Map() };

function busy() {
  el("results").setAttribute("aria-busy", "true");
  document.body.dataset.answer = "older";
  el("quality").textContent = "computing …";
}

function compute() {
  state.sequence += 1;
  busy();
  const waited = performance.now() - coarseAt;
  if (coarseAt && waited < 700) { // the answer on its way is nearly here: the next question follows it
    clearTimeout(again);
    again = setTimeout(() => { if (coarseAt) run(); }, 700 - waited);
    return;
  }
  run();
}

const question = (quality, text, more) => ({ tab: state.tab, quality: quality, text: text, case: state.case, compliance: state.compliance, ...more });

async function run() {
  clearTimeout(again);
  if (asked) asked.abort();
  const own = (asked = new AbortController()), sequence = state.sequence, text = state.text;
  const current = () => asked === own && sequence === state.sequence && !queue.length && !pumping;
  try {
    coarseAt = performance.now();
    const coarse = await opened(await post("answer", question("coarse", text), own.signal));
    coarseAt = 0;
    if (asked !== own) return;
    if (coarse.superseded) { soon(own); return; }
    if (sequence !== state.sequence) { // what came in between is asked now; this answer is older
      show(coarse, sequence, true);
      run();
      return;
    }
    show(coarse, sequence, !current());
    if (!coarse.data) return;
    const fine = await opened(await post("answer", question("fine", text), own.signal));
    if (fine.superseded) { soon(own); return; }
    if (!current()) return;
    show(fine, sequence, false);
    await compareTo(sequence, own, current);
    await fillDerivatives(sequence, own, current);
  } catch (error) {
    if (asked === own) coarseAt = 0;
    if (error.name !== "AbortError") lost(true);
  }
}

// The server has dropped the last question, for another tab say: it is asked once more.
function soon(own) { setTimeout(() => { if (asked === own) run(); }, 300); }

async function opened(answer) {
  if (answer.numbers) Object.assign(answer, { data: JSON.parse(answer.data), array: await unpacked(answer.numbers) });
  return answer;
}

function refuse(problems, what) {
  showProblems(problems);
  verdict("fail", `Not changed${what ? ": " + what : ""}`);
  el("quality").textContent = shown ? "the answer below is that of the file before" : "";
  document.body.dataset.answer = "refused";
}

function verdict(kind, sentence, caution) {
  el("verdict-line").className = `verdict ${kind}`;
  el("verdict-line").textContent = (kind === "pass" ? "✓ " : kind === "fail" ? "✗ " : "") + sentence;
  el("caution").textContent = caution || "";
  el("caution").hidden = !caution;
}

// In the place of an answer where there has been none: why.
function showNoAnswer(reasons) {
  const empty = !shown && reasons !== null;
  el("no-answer").hidden = !empty;
  el("results").classList.toggle("empty", empty);
  if (!empty) return;
  el("no-answer-reasons").replaceChildren(...reasons.map(text => html("li", {}, null, text)));
  el("results").hidden = false;
  el("results").setAttribute("aria-busy", "false");
}

// All of an answer, or nothing of it.
function show(answer, sequence, older) {
  if (answer.superseded) return;
  showProblems(answer.problems || []);
  document.body.dataset.sequence = sequence;
  if (answer.problems || answer.failure) {
    const count = (answer.problems || []).length;
    verdict("fail", answer.failure ? `No answer: ${answer.failure}` : count === 1 ? "A field is wrong" : `${count} mistakes`);
    el("quality").textContent = shown ? "the numbers below are those of an earlier state" : "no answer yet";
    document.body.dataset.answer = older ? "older" : "refused";
    showNoAnswer(answer.failure ? [answer.failure] : answer.problems.map(problem => problem.text));
    return;
  }
  showNoAnswer(null);
  const fine = answer.positions >= 360 || answer.fine;
  const [, head, rest] = answer.sentence.match(/^(.*?[.])(?: (.*))?$/) || ["", answer.sentence, ""];
  verdict(answer.state, head, answer.caution);
  el("name").textContent = answer.drive;
  el("about").textContent = `${answer.load}, ${answer.model}`;
  el("quality").textContent = older ? "computing …" : `${fine ? "" : "coarse: "}${answer.positions} positions${fine ? "" : ", the fine answer is on its way"}. ${rest || ""}`;
  el("warnings").replaceChildren(...answer.warnings.map(line => html("li", {}, null, line)));
  el("verdict-box").innerHTML = answer.html.verdict;
  el("result-box").innerHTML = answer.html.results;
  for (const box of [el("verdict-box"), el("result-box")]) equipTables(box);
  shown = { ...answer, sequence: sequence };
  el("compared-box").hidden = true;
  drawAnswer(answer, null);
  derived.rows.clear();
  showDerivatives();
  document.body.dataset.answer = older ? "older" : fine ? "fine" : "coarse";
  el("results").setAttribute("aria-busy", String(older));
  el("results").hidden = false;
}

// The moving drive and its curves, with a second answer drawn beside.
function drawAnswer(answer, beside) {
  const angle = numbers && degrees ? row("angle")[view.index] : 0;
  content = { ...answer.data, names: [answer.case], compared: null };
  numbers = answer.array;
  if (beside) {
    const all = new Float32Array(numbers.length + beside.array.length);
    all.set(numbers);
    all.set(beside.array, numbers.length);
    content.places = { ...content.places };
    for (const [name, [from, ...shape]] of Object.entries(beside.data.places)) content.places["b/" + name] = [from + numbers.length, ...shape];
    content.compared = { name: beside.name, cases: [beside.case], match: [0] };
    content.axes = {};
    numbers = all;
  }
  for (const kept of [ringScales, scales, alongScales, tiltScales]) kept.clear();
  degrees = Float32Array.from(row("angle"), each => each * 180 / Math.PI);
  el("angle").max = degrees.length - 1;
  view.kase = view.second = 0;
  view.index = nearestAngle(row("angle"), angle);
  if (view.disc >= content.discs) view.disc = 0;
  if (!has("0/light/wheel")) view.torque = "full";
  if (view.chosen) {
    const name = `0/${view.torque}/${view.chosen.kind}/load`;
    if (!has(name) || view.chosen.number >= shapeOf(name)[1]) { view.chosen = null; view.picked = false; }
  }
  if (plots.orders) delete plots.orders; // its place came with the answer
  for (const name in plots) {
    plots[name].spec.x = degrees;
    plots[name].index = view.index;
    plots[name].range = null;
    plots[name].kept = plots[name].ends = null;
    const needed = { share: "0/share", crank: "0/crank", efficiency: "0/efficiency", loss: "0/efficiency" }[name];
    plots[name].figure.hidden = Boolean(needed) && !has(needed);
  }
  if (!el("orders-plot")) delete content.places["0/orders"];
  setUp();
}

// The fine answer of a variant beside this one: its loads and curves, and the scalars of both.
async function compareTo(sequence, own, current) {
  const name = state.beside, text = state.variants[name];
  if (!name || text === undefined) return;
  const key = [state.case, state.compliance, text].join("\n");
  if (!fineAnswers.has(key)) {
    const found = text === state.text ? shown : await opened(await post("answer", question("fine", text), own.signal));
    if (!current() || found.superseded) return;
    if (fineAnswers.size > 6) fineAnswers.delete(fineAnswers.keys().next().value);
    fineAnswers.set(key, found);
  }
  const other = { ...fineAnswers.get(key), name: name };
  if (!current() || shown.sequence !== sequence) return;
  const box = el("compared-box");
  box.hidden = false;
  if (!other.data) {
    el("compared").replaceChildren(html("p", {}, null, `${name} has no answer: ${other.failure || (other.problems || []).map(each => each.text).join(" ")}`));
    return;
  }
  drawAnswer(shown, other);
  const mine = new Map(shown.summary.map(each => [each.key, each])), lines = other.summary.filter(each => mine.has(each.key));
  tableInto("compared", "compared", ["", "this one", name, "change"], lines.map(each => {
    const own = mine.get(each.key), change = each.value ? 100 * (own.value / each.value - 1) : null;
    return [each.title, { text: own.text, value: own.value }, { text: each.text, value: each.value }, { text: known(change) ? `${figure(change, 2)} %` : "–", value: known(change) ? change : "" }];
  }));
}

function tableInto(where, name, head, rows) {
  const box = html("div", { class: "tablebox" }), wide = html("div", { class: "wide", tabindex: "0", role: "group", "aria-label": name }, box);
  const table = html("table", { class: "figures small", "data-name": name }, wide), made = html("tr", {}, html("thead", {}, table)), body = html("tbody", {}, table);
  head.forEach(text => html("th", { scope: "col" }, made, text));
  for (const cells of rows) {
    const line = html("tr", {}, body);
    breakable(html("th", { scope: "row" }, line), cells[0]);
    for (const cell of cells.slice(1)) html("td", cell.value === undefined ? {} : { "data-value": cell.value }, line, cell.text);
  }
  const holder = html("div", {});
  holder.append(box);
  equipTables(holder);
  el(where).replaceChildren(holder);
}

// How results follow the fields that people turn, and those that were asked for, one after the other.
async function fillDerivatives(sequence, own, current) {
  if (!el("derivatives-box").open) return;
  for (const path of [...derived.extra, ...Object.keys(first.declared.turned)]) {
    if (derived.rows.has(path) || !current()) continue;
    if (!derived.extra.includes(path) && state.values[path] === undefined && !Number.isFinite(Number(fieldsByPath.get(path).default || NaN))) continue;
    const found = await post("answer", question("derivative", state.text, { field: path }), own.signal);
    if (!current() || found.superseded) return;
    derived.rows.set(path, found);
    showDerivatives();
  }
}

function askDerivative(path) {
  if (!derived.extra.includes(path)) derived.extra.unshift(path);
  derived.rows.delete(path);
  el("derivatives-box").open = true;
  el("derivatives-box").scrollIntoView({ block: "nearest" });
  if (document.body.dataset.answer === "fine") resume();
}

// What follows the fine answer, with the same answer still shown.
async function resume() {
  const own = (asked = new AbortController()), sequence = state.sequence;
  const current = () => asked === own && sequence === state.sequence && !queue.length && !pumping;
  try {
    await compareTo(sequence, own, current);
    await fillDerivatives(sequence, own, current);
  } catch (error) {
    if (error.name !== "AbortError") lost(true);
  }
}

function showDerivatives() {
  const rows = [...derived.rows], good = rows.filter(([, found]) => found.cells);
  if (!rows.length) { el("derivatives").replaceChildren(html("p", { class: "note" }, null, "These follow the fine answer.")); return; }
  const titles = [...new Set(good.flatMap(([, found]) => found.cells.map(cell => cell.title)))];
  if (good.length) tableInto("derivatives", "derivatives", ["a change of", ...titles], good.map(([path, found]) => [
    `${path} ${`by ${found.step}`.replace(/ /g, "\u00a0")}`, ...titles.map(title => { const cell = found.cells.find(each => each.title === title); return cell ? { text: cell.text, value: cell.value } : { text: "–" }; }),
  ]));
  else el("derivatives").replaceChildren();
  if (good.length) html("p", { class: "note" }, el("derivatives"), good[good.length - 1][1].note);
  for (const [path, found] of rows) if (!found.cells) html("p", { class: "note" }, el("derivatives"), found.failure || (found.problems || []).map(each => each.text).join(" ") || path);
}
