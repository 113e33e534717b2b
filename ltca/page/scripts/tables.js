// Every table copies and downloads with its numbers in full.
function tableRows(table) {
  return [...table.rows].map(row => [...row.cells].map(cell => {
    const text = cell.dataset.value !== undefined ? cell.dataset.value : cell.textContent.replace(/−(?=\d)/g, "-").trim();
    return /^[=@]/.test(text) ? "'" + text : text; // no spreadsheet shall run a name as a formula
  }));
}
function csvText(table) {
  const quoted = text => (/[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  return tableRows(table).map(row => row.map(quoted).join(",")).join("\r\n") + "\r\n";
}
async function copyTable(table) {
  const text = tableRows(table).map(row => row.map(cell => cell.replace(/\s+/g, " ")).join("\t")).join("\n");
  try {
    await navigator.clipboard.writeText(text);
  } catch { // pages that were opened from a file may not
    const area = html("textarea", { "aria-hidden": "true" }, document.body);
    area.value = text;
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  say("table copied");
}
const LONG = 24, SHOWN = 10;
// Rows of a long table after the first ones, shown by a button; what fails is never among them.
function foldRows(table, tools) {
  const rows = [...table.tBodies].flatMap(body => [...body.rows]);
  if (rows.length <= LONG || table.closest("details")) return;
  const folded = rows.slice(SHOWN).filter(row => !row.querySelector(".fail"));
  const button = html("button", { type: "button", class: "tool unfold", "aria-expanded": "false" }, null, "");
  const show = all => {
    folded.forEach(row => row.classList.toggle("folded", !all));
    button.textContent = all ? "Fewer rows" : `All ${rows.length} rows`;
    button.setAttribute("aria-expanded", String(all));
  };
  button.addEventListener("click", () => show(button.getAttribute("aria-expanded") === "false"));
  tools.prepend(button);
  show(false);
}
// Columns beyond the edge of the screen: it fades, and a word says so.
function tellOfColumns(wide, tools) {
  const sign = html("span", { class: "sign screen", "aria-hidden": "true" }, null, "more columns →");
  tools.prepend(sign);
  const look = () => {
    const beyond = wide.scrollWidth - wide.clientWidth;
    wide.classList.toggle("more", beyond - wide.scrollLeft > 2);
    wide.classList.toggle("scrolls", beyond > 2);
    sign.hidden = !(beyond > 2);
    sign.textContent = beyond - wide.scrollLeft > 2 ? "more columns →" : "← more columns";
  };
  wide.addEventListener("scroll", look, { passive: true });
  const watch = new ResizeObserver(look);
  watch.observe(wide);
  watch.observe(wide.firstElementChild);
}
function equipTables(parent) {
  for (const box of parent.querySelectorAll(".tablebox")) {
    const table = box.querySelector("table"), tools = html("div", { class: "tools" }, box);
    const what = table.dataset.name.replace(/_/g, " ");
    html("button", { type: "button", class: "tool", "aria-label": `Copy table ${what}` }, tools, "Copy").addEventListener("click", () => copyTable(table));
    html("button", { type: "button", class: "tool", "aria-label": `Table ${what} as CSV` }, tools, "CSV").addEventListener("click", () => save(`${fileName(table.dataset.name)}.csv`, csvText(table), "text/csv;charset=utf-8"));
    foldRows(table, tools);
    tellOfColumns(box.querySelector(".wide"), tools);
  }
}
equipTables(document);
