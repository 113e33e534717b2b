// The page: undo, variants, cases, and its start.
function showTools() {
  el("undo").disabled = state.at === 0;
  el("redo").disabled = state.at >= state.history.length - 1;
  el("undo").title = state.at ? `Undo ${state.history[state.at].what}` : "";
  el("redo").title = state.at < state.history.length - 1 ? `Redo ${state.history[state.at + 1].what}` : "";
  const fill = (id, names, chosen, none) => {
    const select = el(id), all = none === undefined ? names : ["", ...names];
    if ([...select.options].map(option => option.value).join("\n") !== all.join("\n")) select.replaceChildren(...all.map(name => html("option", { value: name }, null, name || none)));
    select.value = chosen;
  };
  const names = Object.keys(state.variants), now = names.find(name => state.variants[name] === state.text);
  fill("variant", names, now || "", "not kept");
  fill("beside-variant", names, state.beside in state.variants ? state.beside : "", "none");
  fill("case", state.cases.length ? state.cases : ["nominal"], state.cases.length ? state.case : "nominal");
  showSimulators();
  el("case-field").hidden = state.cases.length < 2;
}

function keepVariant() {
  const name = el("variant-name").value.trim().slice(0, 60) || `variant ${Object.keys(state.variants).length}`;
  state.variants[name] = state.text;
  el("variant-name").value = "";
  say(`kept as ${name}`);
  keep();
  showTools();
}

(async () => {
  recall();
  drawing = new Drawing(el("picture"), { tell: (contact, event) => showTip(tipOf(view, contact), event), hide: hideTip, choose: choose });
  listen();
  listenWork();
  buildFields();
  buildNamed();
  el("opening").hidden = true;
  el("all-fields").open = !matchMedia("(max-width: 900px)").matches; // on a phone the answer stands below
  el("file-name").value = first.source.endsWith(".toml") ? first.source.replace(/^.*\//, "").replace(/\.toml$/, "") : `my-${first.source}`;
  el("undo").addEventListener("click", () => step(-1));
  el("redo").addEventListener("click", () => step(1));
  el("find").addEventListener("input", search);
  el("keep-variant").addEventListener("click", keepVariant);
  el("variant").addEventListener("change", event => { if (event.target.value) replaceText(state.variants[event.target.value], `variant ${event.target.value}`); else showTools(); });
  el("beside-variant").addEventListener("change", event => {
    state.beside = event.target.value;
    if (document.body.dataset.answer !== "fine") return;
    if (!state.beside) { el("compared-box").hidden = true; drawAnswer(shown, null); } else resume();
  });
  el("case").addEventListener("change", event => { state.case = event.target.value; replaceText(state.text, ""); });
  el("compliance").addEventListener("change", event => { state.compliance = event.target.value; compute(); });
  el("derivatives-box").addEventListener("toggle", () => { if (el("derivatives-box").open && document.body.dataset.answer === "fine") resume(); });
  let typing = 0;
  el("text").addEventListener("input", () => { busy(); clearTimeout(typing); typing = setTimeout(() => replaceText(el("text").value, "the text"), 400); });
  el("again").addEventListener("click", () => replaceText(state.text, ""));
  document.addEventListener("keydown", event => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.closest("textarea")) return;
    event.preventDefault();
    if (document.activeElement && document.activeElement.closest("input, select")) document.activeElement.blur();
    step(event.shiftKey ? 1 : -1);
  });
  addEventListener("pagehide", () => navigator.sendBeacon("leave", new Blob([JSON.stringify({ tab: state.tab })], { type: "application/json" })));
  replaceText(state.text, "as opened");
  lookAtJobs();
  document.documentElement.dataset.ready = "yes";
})();
