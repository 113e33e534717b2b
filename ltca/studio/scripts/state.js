// What the page has: the text of a drive file with its history and variants, and what it asks the server.
const first = JSON.parse(el("data").textContent);
const state = {
  tab: crypto.randomUUID(), text: first.text, case: first.case, values: {}, own: new Set(), cases: [], entries: {}, named: {},
  history: [{ text: first.text, what: "as opened" }], at: 0, variants: { "as opened": first.text }, beside: "", compliance: "cached",
  sequence: 0, // of the last change; an answer of another one is older
};
const KEPT = "cyclo-studio " + first.source;

async function post(path, body, signal) {
  const response = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), signal: signal, cache: "no-store" });
  if (!response.ok) throw new Error((await response.text()).slice(0, 300));
  const found = await response.json();
  lost(false);
  return found;
}

// The server is gone: nothing of the page is, and it can be taken along.
function lost(is) { el("lost").hidden = !is; }

function keep() {
  try {
    sessionStorage.setItem(KEPT, JSON.stringify({ text: state.text, case: state.case, variants: state.variants, history: state.history.slice(Math.max(0, state.at - 20), state.at + 1) }));
  } catch { /* full: a page that is loaded anew starts anew */ }
}
function recall() {
  try {
    const kept = JSON.parse(sessionStorage.getItem(KEPT) || "null");
    if (kept && typeof kept.text === "string") Object.assign(state, { text: kept.text, case: kept.case, variants: kept.variants, history: kept.history, at: kept.history.length - 1 });
  } catch { /* of another version */ }
}

// Changes wait while one is on its way: each is made in the text that the one before has left.
let queue = [], pumping = false;
function change(path, typed) {
  clearMessage(path);
  const last = queue[queue.length - 1];
  if (last && last.changes && last.what === path) last.changes[path] = typed;
  else queue.push({ what: path, changes: { [path]: typed } });
  busy();
  pump();
}
function replaceText(text, what) { queue.push({ what: what, text: text }); busy(); pump(); }
function changeEntries(what, asked, then) { queue.push({ what: what, asked: asked, then: then }); busy(); pump(); }

async function pump() {
  if (pumping) return;
  pumping = true;
  try {
    while (queue.length) {
      const next = queue.shift(), text = next.text === undefined ? state.text : next.text;
      const found = await post("edit", { text: text, case: state.case, changes: next.changes || {}, ...next.asked });
      if (next.then) next.then(found.problems || []);
      if (found.problems) { if (next.then) compute(); else refuse(found.problems, next.what); continue; }
      take(found, next.what, Boolean(next.changes), next.at);
    }
  } catch (error) {
    lost(true);
    queue = [];
  } finally {
    pumping = false;
  }
}

let changed = { what: "", when: 0 };
function take(found, what, merges, at) {
  const now = performance.now(), again = merges && changed.what === what && now - changed.when < 1500 && state.at === state.history.length - 1 && state.at > 0;
  if (at !== undefined) state.at = at;
  else if (found.text !== state.text || !state.sequence) {
    if (again) state.history[state.at] = { text: found.text, what: what };
    else if (found.text !== state.history[state.at].text) {
      state.history = [...state.history.slice(Math.max(0, state.at - 200), state.at + 1), { text: found.text, what: what }];
      state.at = state.history.length - 1;
    }
  }
  changed = { what: what, when: now };
  const place = state.cases.indexOf(state.case), renamed = found.cases.length === state.cases.length; // a case stays chosen by another name
  Object.assign(state, { text: found.text, values: found.values, own: new Set(found.own), cases: found.cases, entries: found.entries, named: found.named });
  if (state.cases.length && !state.cases.includes(state.case)) state.case = state.cases[renamed && place >= 0 ? place : 0];
  keep();
  showFields();
  showTools();
  compute();
}

function step(by) {
  const at = state.at + by;
  if (at < 0 || at >= state.history.length) return;
  queue.push({ what: "", text: state.history[at].text, at: at });
  changed = { what: "", when: 0 };
  busy();
  pump();
}
