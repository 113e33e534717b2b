// Curves of sections, in the boxes that wait for them.
function drawSections() {
  const boxes = [...document.querySelectorAll("[data-plots]")].flatMap(box => Array(Number(box.dataset.plots)).fill(box));
  return content.plots.map((told, number) => {
    const x = row(`plot/${number}/x`), stems = told.kind === "stems";
    const plot = new Plot(boxes[number], { id: `plot${number}`, unit: told.unit, x: x, xTitle: told.axis, degrees: told.degrees, stems: stems, points: told.kind === "points", bars: told.kind === "bars", marks: told.marks, range: told.range, height: told.range ? 320 : 190, zero: stems || told.kind === "bars" });
    plot.set(told.title, told.names.map((name, i) => ({ name: name, values: row(`plot/${number}/${i}`), colour: `c${i % 6 + 1}`, dashed: i >= 6, large: told.large.includes(name) })));
    return plot;
  });
}
