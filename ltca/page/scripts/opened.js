// The page of a run: its numbers are in it.
(async () => {
  try {
    await openNumbers();
  } catch (error) {
    el("opening").textContent = `This browser cannot open the numbers of the moving drive (${error.message}); the tables below stand.`;
    return;
  }
  degrees = Float32Array.from(row("angle"), angle => angle * 180 / Math.PI);
  el("angle").max = degrees.length - 1;
  el("angle").disabled = el("play").disabled = degrees.length < 2;
  if (content.compared) view.second = content.compared.match[0] || 0;
  drawing = new Drawing(el("picture"), { tell: (contact, event) => showTip(tipOf(view, contact), event), hide: hideTip, choose: choose });
  setUp();
  listen();
  el("opening").hidden = true;
  document.documentElement.dataset.ready = "yes";
})();
