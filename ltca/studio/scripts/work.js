// Saving, exports and commands in the background.
function download() { save(`${fileName(el("file-name").value || state.values.name || "drive")}.toml`, state.text, "application/toml"); }

async function saveFile(overwrite) {
  const name = el("file-name").value;
  try {
    const found = await post("save", { text: state.text, name: name, overwrite: overwrite });
    el("overwrite").hidden = !found.exists;
    el("saved").textContent = found.problems ? found.problems.map(each => each.text).join(" ") : found.exists ? `${found.exists} is there already.` : `${found.saved} is written in the folder of the studio.`;
  } catch { lost(true); }
}

async function startJob(job) {
  try {
    const found = await post("jobs", { text: state.text, case: state.case, job: job });
    el("job-message").textContent = found.problems ? found.problems.map(each => each.text).join(" ") : `Job ${found.number} is started.`;
    lookAtJobs();
  } catch { lost(true); }
}

let looking = 0;
async function lookAtJobs() {
  clearTimeout(looking);
  try {
    const response = await fetch("jobs", { cache: "no-store" });
    const { jobs } = await response.json();
    showJobs(jobs);
    if (jobs.some(job => job.state === "running")) looking = setTimeout(lookAtJobs, 1000);
  } catch { lost(true); }
}

// Rows stay while they are the same job: a button that has the focus keeps it.
function showJobs(jobs) {
  const list = el("jobs");
  for (const job of [...jobs].reverse()) {
    let row = list.querySelector(`[data-job="${job.number}"]`);
    if (!row) {
      row = html("li", { "data-job": job.number });
      list.prepend(row);
      html("p", { class: "job-head" }, row);
      html("progress", { "aria-label": `Job ${job.number}` }, row);
      html("pre", { class: "job-lines", tabindex: "0", "aria-label": `Output of job ${job.number}` }, row);
      html("button", { type: "button", class: "cancel" }, row, "Cancel").addEventListener("click", async () => { try { await post(`jobs/${job.number}/cancel`, {}); } catch { lost(true); } lookAtJobs(); });
      html("ul", { class: "files" }, row);
    }
    row.querySelector(".job-head").textContent = `${job.number}: ${job.command} — ${job.state}, ${job.seconds} s`;
    row.querySelector(".job-lines").textContent = job.lines.join("\n") || "…";
    row.querySelector(".cancel").hidden = job.state !== "running";
    const bar = row.querySelector("progress");
    bar.hidden = job.state !== "running";
    if (job.done.length) place(bar, { value: job.done[0], max: Math.max(job.done[1], 1) }); else bar.removeAttribute("value");
    const files = row.querySelector(".files");
    if (files.children.length !== job.files.length) files.replaceChildren(...job.files.map(path => {
      const item = html("li", {});
      html("a", { href: `files/${path.split("/").map(encodeURIComponent).join("/")}`, target: "_blank", rel: "noopener" }, item, path.split("/").slice(3).join("/"));
      return item;
    }));
    row.dataset.state = job.state;
  }
}

// A URDF has a velocity: it cannot be had of a drive without a speed.
function showSimulators() {
  const option = [...el("simulator").options].find(each => each.value === "urdf");
  if (!option) return;
  option.disabled = !Object.keys(state.values).some(name => name === "load.speed" || /^duty\.\d+\.speed$/.test(name));
  el("urdf-note").hidden = !option.disabled;
  el("simulate").disabled = option.disabled && el("simulator").value === "urdf";
}

function listenWork() {
  const fill = (id, names) => { for (const name of names) html("option", { value: name }, el(id), name); };
  fill("export-format", first.exports.formats);
  fill("export-part", first.exports.parts);
  fill("simulator", first.exports.simulators);
  el("simulators").hidden = el("simulator-note").hidden = !first.exports.simulators.length;
  el("simulator").addEventListener("change", showSimulators);
  el("save").addEventListener("click", () => saveFile(false));
  el("overwrite").addEventListener("click", () => saveFile(true));
  el("file-name").addEventListener("input", () => { el("overwrite").hidden = true; });
  for (const button of document.querySelectorAll(".download")) button.addEventListener("click", download);
  el("export").addEventListener("click", () => startJob({ kind: "export", format: el("export-format").value, part: el("export-part").value }));
  el("simulate").addEventListener("click", () => startJob({ kind: "simulator", simulator: el("simulator").value }));
  el("fem").addEventListener("click", () => startJob({ kind: "fem" }));
  el("derive").addEventListener("click", () => startJob({ kind: "derive" }));
  el("tolerance").addEventListener("click", () => startJob({ kind: "tolerance", samples: Math.round(Number(el("samples").value)) || 0 }));
}
