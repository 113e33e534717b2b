// Curves of sections, in the boxes that wait for them.
function drawSections() {
  const boxes = [...document.querySelectorAll("[data-plots]")].flatMap(box => Array(Number(box.dataset.plots)).fill(box));
  return content.plots.map((told, number) => {
    const x = row(`plot/${number}/x`), stems = told.kind === "stems";
    const flat = stems || told.kind === "bars", alone = boxes[number].dataset.plots === "1";
    const plot = new Plot(boxes[number], { id: `plot${number}`, unit: told.unit, x: x, xTitle: told.axis, degrees: told.degrees, stems: stems, points: told.kind === "points", bars: told.kind === "bars", marks: told.marks, range: told.range, zero: flat, height: told.range ? 320 : alone && !told.marks ? 280 : 190, axis: told.up, along: told.along });
    let own = -1; // a dashed line has the colour of the one before
    plot.set(told.title, told.names.map((name, i) => {
      if (told.beside && told.beside[i]) return { name: name, values: row(`plot/${number}/${i}`), colour: "c-beside", dashed: true, thin: true, label: told.beside[i] };
      const colour = told.dashed[i] ? own : ++own;
      return { name: name, values: row(`plot/${number}/${i}`), colour: `c${colour % 6 + 1}`, dashed: told.dashed[i] || colour >= 6, large: told.large.includes(name) };
    }));
    return plot;
  });
}
