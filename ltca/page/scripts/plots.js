// Curves over an axis as SVG: sharp in print, in the colours of the page, taken along as they are.
function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count) || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map(part => part * power).find(each => each >= raw * 0.999);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return { found: found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (step / power === 2.5 ? 1 : 0)) };
}
function degreeTicks(low, high, room) {
  const whole = high - low > 300 && high - low <= 360 ? 60 : 0; // of a turn, as in the figures
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 90, 120, 180, 360, 720, 1440].find(each => each >= whole && (high - low) / each <= room / 40) || 3600;
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-6; i++) found.push(i * step);
  return { found: found, digits: step < 1 ? 1 : 0 };
}

// Ticks of an axis that comes with its range and step, from its first end on.
function stepTicks(axis) {
  const [low, high, step] = axis, count = Math.round((high - low) / step), first = Math.round(low / step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), part = step * 10 ** digits;
  return { found: Array.from({ length: count + 1 }, (_, i) => (first + i) * step), digits: digits + (Math.abs(part - Math.round(part)) > 1e-6 ? 1 : 0) };
}

function ends(lines) {
  let low = Infinity, high = -Infinity;
  for (const values of lines) for (const value of values) if (known(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  return [low, high];
}

const shortened = (text, most) => (text.length > most ? text.slice(0, most - 1) + "…" : text);

class Plot {
  // spec: {id, title, unit, x, xTitle, degrees, zero, stems, bars, points, joined, levels, marks, range, pick(index), digits, axis, along}; axes are
  // [low, high, step], a range is [first, last, low, high]
  constructor(parent, spec) {
    this.spec = spec;
    this.series = [];
    this.range = null;
    this.index = 0;
    this.figure = html("figure", { class: "plot", "data-plot": spec.id }, parent);
    const caption = html("figcaption", {}, this.figure);
    this.title = html("span", {}, caption);
    const button = html("button", { type: "button", class: "tool" }, caption, "SVG");
    button.addEventListener("click", () => saveSvg(this.svg, this.title.textContent));
    this.button = button;
    this.svg = node("svg", { role: "img", tabindex: spec.pick ? 0 : -1 }, this.figure);
    this.keys = html("div", { class: "keys" }, this.figure);
    if (spec.pick) this.listen();
  }

  listen() {
    const at = event => {
      const box = this.svg.getBoundingClientRect(), x = (event.clientX - box.left) * this.width / box.width;
      return this.low + (this.high - this.low) * Math.max(0, Math.min(1, (x - this.left) / (this.width - this.left - 18)));
    };
    let down = null;
    this.svg.addEventListener("pointerdown", event => { down = [event.clientX, at(event)]; });
    this.svg.addEventListener("pointerup", event => {
      if (!down) return;
      if (event.pointerType === "mouse" && Math.abs(event.clientX - down[0]) > 12) { // a drag looks closer
        this.range = [down[1], at(event)].sort((a, b) => a - b);
        this.draw();
      } else this.spec.pick(this.nearest(at(event)));
      down = null;
    });
    this.svg.addEventListener("dblclick", () => { this.range = null; this.draw(); });
    this.svg.addEventListener("pointermove", event => { if (event.pointerType === "mouse") this.tell(this.nearest(at(event))); });
    this.svg.addEventListener("pointerleave", () => { down = null; this.tell(this.index); });
  }

  nearest(value) {
    const x = this.spec.x;
    let best = 0;
    for (let i = 1; i < x.length; i++) if (Math.abs(x[i] - value) < Math.abs(x[best] - value)) best = i;
    return best;
  }

  // series: {name, values, x, colour, faint, dashed, thin, label}; of many lines drawn as one: {many, key}
  set(title, series) {
    this.title.textContent = title + (this.spec.unit ? `, ${this.spec.unit}` : "");
    this.button.setAttribute("aria-label", `Figure ${title} as SVG`);
    this.series = series;
    this.draw();
  }

  again() {
    this.width = 0;
    this.draw();
  }

  draw() {
    // To ask for the width lays the page out: once, and when it changes.
    const spec = this.spec, width = this.width || (this.width = Math.max(260, Math.round(this.figure.clientWidth || 520))), height = spec.height || 190;
    const left = (this.left = 54), right = 18, top = 10, bottom = 34, svg = this.svg;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.replaceChildren();
    let low = Infinity, high = -Infinity, first = Infinity, last = -Infinity;
    for (const line of this.series) {
      const [least, most] = line.many ? this.extremes(line) : ends([line.values]);
      low = Math.min(low, least);
      high = Math.max(high, most);
      for (const x of line.x || spec.x) { first = Math.min(first, x); last = Math.max(last, x); }
    }
    if (low > high) { low = 0; high = 1; }
    if (spec.zero || low === high) { low = Math.min(0, low); high = Math.max(0, high); }
    if (low === high) high = low + 1;
    const told = [low, high], axis = spec.axis || null;
    if (axis) [low, high] = axis;
    const room = (axis ? 0.03 : 0.05) * (high - low), fromZero = spec.zero || axis;
    if (!(fromZero && low === 0) && !spec.range) low -= room;
    if (!(fromZero && high === 0) && !spec.range) high += room;
    if (spec.along) [first, last] = spec.along;
    else if (spec.stems) { first -= 0.5; last += 0.5; }
    const half = spec.bars && spec.x.length > 1 ? 0.5 * (spec.x[1] - spec.x[0]) : 0;
    if (spec.bars) { first -= half; last += half; }
    for (const mark of spec.marks || []) if (mark.shown) { first = Math.min(first, mark.value); last = Math.max(last, mark.value); }
    if (spec.levels || spec.marks || (spec.points && !spec.range && !spec.along)) { const side = 0.04 * (last - first) || 0.5; first -= side; last += side; }
    if (spec.range) [first, last, low, high] = spec.range;
    if (spec.degrees && first >= 0 && last > 350 && last < 360) last = 360; // a whole turn
    [this.low, this.high] = this.range || [first, last];
    if (this.low === this.high) { this.low -= 1; this.high += 1; }
    const X = (this.X = value => left + (value - this.low) / (this.high - this.low) * (width - left - right));
    const Y = (this.Y = value => height - bottom - (value - low) / (high - low) * (height - top - bottom));
    const text = (x, y, words, anchor) => node("text", { class: "axis-text", x: x, y: y, "text-anchor": anchor }, svg, words);
    const up = axis ? stepTicks(axis) : ticks(low, high, 4);
    for (const value of up.found) {
      node("line", { class: "grid", x1: left, x2: width - right, y1: Y(value), y2: Y(value) }, svg);
      text(left - 6, Y(value) + 4, figure(value, up.digits), "end");
    }
    const steps = spec.along && !this.range && (width - left) / stepTicks(spec.along).found.length > 34;
    const along = spec.levels ? { found: spec.levels.map((name, i) => i) } : spec.degrees ? degreeTicks(this.low, this.high, width - left) : steps ? stepTicks(spec.along) : ticks(this.low, this.high, (width - left) / 56);
    for (const value of along.found) {
      node("line", { class: "grid", x1: X(value), x2: X(value), y1: height - bottom, y2: height - bottom + 4 }, svg);
      const word = spec.levels ? shortened(spec.levels[value], Math.max(3, Math.floor((width - left) / (7 * spec.levels.length)))) : figure(value, along.digits) + (spec.degrees ? "°" : "");
      text(X(value), height - bottom + 16, word, "middle");
    }
    text(width - right, height - 4, spec.xTitle, "end");
    const frame = node("svg", { x: left, y: 0, width: width - left - right, height: height, viewBox: `${left} 0 ${width - left - right} ${height}` }, svg);
    for (const line of this.series) {
      const group = node("g", { class: line.colour }, frame);
      if (spec.stems) {
        const step = Math.max(1.5, Math.min(6, (X(1) - X(0)) * 0.22));
        line.values.forEach((value, i) => { if (known(value)) node("line", { class: "stem", "stroke-width": step, x1: X(spec.x[i]), x2: X(spec.x[i]), y1: Y(0), y2: Y(value) }, group); });
      } else if (spec.bars) {
        line.values.forEach((value, i) => { if (value > 0) node("rect", { class: "bar", x: X(spec.x[i] - half), width: Math.max(0.5, X(spec.x[i] + half) - X(spec.x[i] - half) - 0.6), y: Y(value), height: Y(0) - Y(value) }, group); });
      } else if (spec.points) {
        if (spec.joined) node("path", { class: "curve thin", d: this.joined(line, spec.joined) }, group);
        // One path of dots: thousands of circles would make a page slow.
        let dots = "";
        line.values.forEach((value, i) => {
          const inside = !spec.range || (spec.x[i] >= this.low && spec.x[i] <= this.high && value >= low && value <= high);
          if (known(value) && inside) dots += `M${X(spec.x[i]).toFixed(1)},${Y(value).toFixed(1)}h0`;
        });
        node("path", { class: "dots", "stroke-width": line.large ? 8 : spec.x.length > 1000 ? 2.4 : 4, d: dots }, group);
      } else if (line.many) frame.replaceChild(this.together(line, [width, this.low, this.high, low, high].join()), group);
      else node("path", { class: `curve${line.faint || line.thin ? " thin" : ""}${line.dashed ? " dashed" : ""}`, d: this.path(line) }, group);
    }
    // Texts on lines, each a little further in than the one before, since several may leave at the same place.
    this.series.filter(line => line.label).forEach((line, i) => {
      const inside = line.values.map((value, k) => (value >= low && value <= high ? k : 0)).reduce((a, b) => Math.max(a, b), 0);
      const at = Math.round(inside * (0.96 - 0.085 * (i % 8)));
      node("text", { class: "axis-text on-line", x: X(spec.x[at]), y: Y(line.values[at]) + 4, "text-anchor": "middle" }, frame, line.label);
    });
    for (const mark of spec.marks || []) if (mark.shown) {
      const group = node("g", { class: mark.colour }, frame);
      node("line", { class: `curve${mark.dashed ? " dashed" : ""}`, x1: X(mark.value), x2: X(mark.value), y1: top, y2: height - bottom }, group);
    }
    this.spot = node("circle", { class: "spot", r: 5, visibility: "hidden" }, frame);
    this.svg.setAttribute("aria-label", `${this.title.textContent}, from ${figure(told[0])} to ${figure(told[1])}`);
    this.line = spec.pick ? node("line", { class: "cursor", y1: top, y2: height - bottom }, frame) : null;
    this.marks = spec.pick ? this.series.map(line => (line.faint || line.x ? null : node("circle", { class: `mark ${line.colour}`, r: 3.2 }, frame))) : [];
    this.tell(this.index);
  }

  extremes(line) {
    if (!this.ends || this.ends.key !== line.key) this.ends = { key: line.key, found: ends(line.many) };
    return this.ends.found;
  }

  // Many lines in one element, kept as long as lines and scales are the same.
  together(line, scales) {
    const key = `${line.key},${scales}`;
    if (!this.kept || this.kept.key !== key) {
      const group = node("g", { class: line.colour });
      node("path", { class: "curve thin", d: line.many.map(values => this.path({ values: values })).join("") }, group);
      this.kept = { key: key, group: group };
    }
    return this.kept.group;
  }

  // Rings a point, [x, y], or none for null.
  mark(point) {
    const seen = point && known(point[1]);
    this.spot.setAttribute("visibility", seen ? "visible" : "hidden");
    if (!seen) return;
    this.spot.setAttribute("cx", this.X(point[0]));
    this.spot.setAttribute("cy", this.Y(point[1]));
  }

  // Points by number in the order of a path, which breaks where there is no number.
  joined(line, order) {
    let text = "", pen = false;
    for (const i of order) {
      if (!known(i) || !known(line.values[i])) { pen = false; continue; }
      text += `${pen ? "L" : "M"}${this.X(this.spec.x[i]).toFixed(1)},${this.Y(line.values[i]).toFixed(1)}`;
      pen = true;
    }
    return text;
  }

  path(line) {
    const x = line.x || this.spec.x;
    let text = "", pen = false;
    for (let i = 0; i < x.length; i++) {
      if (!known(line.values[i])) { pen = false; continue; }
      text += `${pen ? "L" : "M"}${this.X(x[i]).toFixed(1)},${this.Y(line.values[i]).toFixed(1)}`;
      pen = true;
    }
    return text;
  }

  cursor(index) {
    this.index = index;
    this.tell(index);
  }

  tell(index) {
    const spec = this.spec;
    if (this.line) {
      const at = this.X(spec.x[index]);
      place(this.line, { x1: at, x2: at });
      this.marks.forEach((mark, i) => {
        if (!mark) return;
        const value = this.series[i].values[index];
        mark.style.display = known(value) ? "" : "none";
        if (known(value)) place(mark, { cx: at, cy: this.Y(value) });
      });
    }
    const named = [...this.series.filter(line => line.name), ...(spec.marks || [])];
    if (this.keys.children.length !== named.length) this.keys.replaceChildren(...named.map(() => {
      const key = html("span", {});
      html("span", {}, key);
      html("span", {}, key);
      html("b", {}, key);
      return key;
    }));
    named.forEach((line, i) => {
      const [mark, words, value] = this.keys.children[i].children;
      mark.className = `key ${line.colour}${line.dashed ? " dash" : ""}`;
      words.textContent = line.name + " ";
      value.textContent = spec.pick && line.values && !line.faint && !line.x ? `${figure(line.values[index], spec.digits)}${spec.unit === "arc seconds" ? "″" : spec.unit ? " " + spec.unit : ""}` : "";
    });
  }
}
