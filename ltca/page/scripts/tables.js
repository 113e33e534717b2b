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
for (const box of document.querySelectorAll(".tablebox")) {
  const table = box.querySelector("table"), tools = html("div", { class: "tools" }, box);
  const what = table.dataset.name.replace(/_/g, " ");
  html("button", { type: "button", class: "tool", "aria-label": `Copy table ${what}` }, tools, "Copy").addEventListener("click", () => copyTable(table));
  html("button", { type: "button", class: "tool", "aria-label": `Table ${what} as CSV` }, tools, "CSV").addEventListener("click", () => save(`${fileName(table.dataset.name)}.csv`, csvText(table), "text/csv;charset=utf-8"));
}
