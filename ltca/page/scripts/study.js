// Curves of a page without a drive.
(async () => {
  try {
    await openNumbers();
  } catch (error) {
    el("opening").textContent = `This browser cannot open the numbers of the curves (${error.message}); the tables stand.`;
    return;
  }
  const boxes = [...document.querySelectorAll("[data-plots]")].flatMap(box => Array(Number(box.dataset.plots)).fill(box));
  const drawn = content.plots.map((told, number) => {
    const x = row(`${number}/x`), stems = told.kind === "stems";
    const plot = new Plot(boxes[number], { id: String(number), unit: told.unit, x: x, xTitle: told.axis, degrees: told.degrees, stems: stems, points: told.kind === "points", zero: stems });
    plot.set(told.title, told.names.map((name, i) => ({ name: name, values: row(`${number}/${i}`), colour: `c${i % 6 + 1}`, dashed: i >= 6 })));
    return plot;
  });
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; drawn.forEach(plot => plot.draw()); } });
  document.documentElement.dataset.ready = "yes";
})();
