// Curves of a page without a drive.
(async () => {
  try {
    await openNumbers();
  } catch (error) {
    el("opening").textContent = `This browser cannot open the numbers of the curves (${error.message}); the tables stand.`;
    return;
  }
  const drawn = [...drawSections(), ...drawResponses()];
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; drawn.forEach(plot => plot.again()); } });
  document.documentElement.dataset.ready = "yes";
})();
