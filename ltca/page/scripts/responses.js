// Quantities of a sweep over one of its factors: every sample, the one under the pointer in all plots.
function drawResponses() {
  const box = document.querySelector("[data-responses]");
  if (!box) return [];
  const told = content.responses, samples = row("responses/sample"), columns = told.factors.map((factor, i) => row(`responses/factor/${i}`));
  const controls = html("div", { class: "controls" }, box), status = html("p", { class: "note told", role: "status" }, box), grid = html("div", { class: "plots" }, box);
  const rest = `${samples.length} samples; point at one to see it in every plot.`;
  const level = (i, value) => (told.factors[i].levels ? told.factors[i].levels[value] : figure(value));
  status.textContent = rest;
  const plots = told.quantities.map((name, j) => {
    const values = row(`responses/quantity/${j}`);
    const plot = new Plot(grid, { id: `response${j}`, unit: "", x: columns[0], points: true, xTitle: "" });
    plot.values = values;
    const show = event => {
      const frame = plot.svg.getBoundingClientRect(), scale = plot.width / frame.width;
      const at = [(event.clientX - frame.left) * scale, (event.clientY - frame.top) * scale];
      let best = -1, least = 400;
      for (let i = 0; i < samples.length; i++) {
        if (!known(values[i])) continue;
        const far = (plot.X(plot.spec.x[i]) - at[0]) ** 2 + (plot.Y(values[i]) - at[1]) ** 2;
        if (far < least) { least = far; best = i; }
      }
      choose(best);
    };
    plot.svg.addEventListener("pointermove", show);
    plot.svg.addEventListener("pointerdown", show);
    plot.svg.addEventListener("pointerleave", () => choose(-1));
    return plot;
  });
  let chosen = -1;
  function choose(sample) {
    if (sample === chosen) return;
    chosen = sample;
    for (const plot of plots) plot.mark(sample < 0 ? null : [plot.spec.x[sample], plot.values[sample]]);
    status.textContent = sample < 0 ? rest : `sample ${samples[sample]}: ` + told.factors.map((factor, i) => `${factor.title} ${level(i, columns[i][sample])}`).join(", ");
  }
  function over(i) {
    const path = row(`responses/path/${i}`);
    plots.forEach((plot, j) => {
      Object.assign(plot.spec, { x: columns[i], xTitle: told.factors[i].title, levels: told.factors[i].levels, joined: path.length ? path : null });
      plot.set(told.quantities[j], [{ name: "", values: plot.values, colour: "c1" }]);
    });
  }
  if (told.factors.length > 1) {
    const field = html("label", { class: "field" }, controls);
    html("span", {}, field, "over");
    const select = html("select", {}, field);
    told.factors.forEach((factor, i) => html("option", { value: i }, select, factor.title));
    select.addEventListener("change", () => { choose(-1); over(Number(select.value)); });
  }
  over(0);
  return plots;
}
