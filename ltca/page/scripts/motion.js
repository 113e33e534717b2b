// Numbers of a run, and where everything stands at a position.
let content = null, numbers = null;

// Arrays as a page has them (ltca/page/packing.py), unpacked.
async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), sign => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer()), count = planes.length / 4, bytes = new Uint8Array(planes.length);
  for (let plane = 0; plane < 4; plane++) for (let i = 0, from = plane * count; i < count; i++) bytes[4 * i + plane] = planes[from + i];
  const view = new DataView(bytes.buffer), found = new Float32Array(count);
  for (let i = 0; i < count; i++) found[i] = view.getFloat32(4 * i, true);
  return found;
}
async function openNumbers() {
  content = JSON.parse(el("data").textContent);
  numbers = await unpacked(el("numbers").textContent);
}

const has = name => name in content.places;
// The values over all positions of one row of an array: of a disc and contact, say.
function row(name, ...index) {
  const [first, ...shape] = content.places[name], length = shape[shape.length - 1];
  let at = 0;
  index.forEach((each, i) => { at = at * shape[i] + each; });
  return numbers.subarray(first + at * length, first + (at + 1) * length);
}
const shapeOf = name => content.places[name].slice(1);

const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
const plus = ([a, b], [c, d]) => [a + c, b + d];
const less = ([a, b], [c, d]) => [a - c, b - d];
const turned = angle => [Math.cos(angle), Math.sin(angle)];
const unit = ([a, b]) => { const size = Math.hypot(a, b) || 1; return [a / size, b / size]; };

// Point and outward normal of the flank at a parameter, from its outline, whose points are even in it: cubics between them.
function flankAt(outline, parameter) {
  const count = outline.length, place = parameter / (2 * Math.PI) * count, low = Math.floor(place), t = place - low;
  const at = i => outline[(((low + i) % count) + count) % count];
  const along = i => [0, 1].map(c => (8 * (at(i + 1)[c] - at(i - 1)[c]) - (at(i + 2)[c] - at(i - 2)[c])) / 12);
  const weights = [-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6];
  const between = of => [0, 1].map(c => weights.reduce((sum, weight, i) => sum + weight * of(i - 1)[c], 0));
  const tangent = between(along);
  return { point: between(at), normal: unit([tangent[1], -tangent[0]]) };
}

const KINDS = { pin: "wheel pin", outer: "roller", hole: "shaft pin" };
function contactName(kind, number) {
  if (kind !== "outer" || content.cranks === 1) return `${KINDS[kind]} ${number}`;
  const each = shapeOf("0/full/outer/load")[1] / content.cranks;
  return `crank ${Math.floor(number / each)}, roller ${number % each}`;
}

// How much larger the shape of the ring is drawn: its largest displacement is a twentieth of the picture, rounded.
const ringScales = new Map();
function ringScale(view) {
  const prefix = `${view.kase}/${view.torque}/ring/`;
  if (!has(prefix + "radial")) return 0;
  if (!ringScales.has(prefix)) {
    let most = 0;
    for (const way of ["radial", "tangential"]) {
      const [first, ...shape] = content.places[prefix + way];
      for (let i = first; i < first + shape.reduce((a, b) => a * b, 1); i++) most = Math.max(most, Math.abs(numbers[i]) || 0);
    }
    const whole = most > 0 ? content.cases[view.kase].scenes[0].reach / 20 / most : 1, power = 10 ** Math.floor(Math.log10(whole));
    ringScales.set(prefix, power * [5, 2, 1].find(each => each * power <= whole));
  }
  return ringScales.get(prefix);
}
// Edges of the ring with its displacements enlarged: a smooth closed line through the angles of the pins.
function ringAt(view, prefix, wheel) {
  const scene = content.cases[view.kase].scenes[view.disc], scale = ringScale(view);
  if (!scene.ring || !scale) return null;
  const moved = scene.pins.map(([x, y], i) => {
    const out = unit([x, y]), each = ["radial", "tangential"].map(way => scale * row(`${prefix}ring/${way}`, i)[view.index]);
    return [out, times(out, each)];
  });
  return scene.ring.map(radius => moved.map(([out, by]) => plus(scene.wheelAxis, times(plus([radius * out[0], radius * out[1]], by), wheel))));
}

// Everything at one position: parts as circles, contacts with place and direction of the force on the disc.
function placesAt(view) {
  const scene = content.cases[view.kase].scenes[view.disc], prefix = `${view.kase}/${view.torque}/`;
  const k = view.index, angle = row("angle")[k], of = name => row(prefix + name, view.disc)[k];
  const rotation = of("rotation"), turn = turned(rotation), wheel = turned(angle / scene.ratio + row(prefix + "wheel")[k]);
  const phase = scene.phase.reduce((sum, each) => sum + each, 0) / scene.phase.length;
  const races = scene.axes.map((axis, i) => plus(axis, times([scene.eccentricity[i], 0], turned(angle + scene.phase[i]))));
  const middle = races.reduce(plus, [0, 0]).map(value => value / races.length);
  const disc = plus(middle, times([of("radial"), of("tangential")], turned(angle + phase)));
  const pins = scene.pins.map(([x, y, r]) => [...plus(scene.wheelAxis, times([x, y], wheel)), r]);
  const each = scene.rollers[0].length / scene.axes.length, around = scene.cageSpeed * angle;
  const ring = ringAt(view, prefix, wheel);
  const rollers = scene.rollers[0].map((cage, i) => {
    const crank = Math.floor(i / each), r = scene.rollers[1][i];
    return [...plus(races[crank], times([scene.race + r, 0], turned(around + cage))), r];
  });
  const found = {
    known: known(rotation), angle: angle, contacts: [],
    disc: [...disc, rotation], cranks: races.map((race, i) => [...scene.axes[i], ...race]),
    pins: pins, rollers: rollers, shafts: scene.shafts, ring: ring,
  };
  if (!found.known) found.disc = [...middle, 0];
  const inWorld = point => plus(disc, times(point, turn));
  for (const kind of ["pin", "outer", "hole"]) {
    for (let number = 0; number < shapeOf(`${prefix}${kind}/load`)[1]; number++) {
      const value = quantity => row(`${prefix}${kind}/${quantity}`, view.disc, number)[k];
      const load = value("load"), chosen = view.chosen && view.chosen.kind === kind && view.chosen.number === number;
      if (!(load > 0) && !chosen) continue;
      if (!found.known) continue;
      let at, to;
      if (kind === "pin") {
        const flank = flankAt(scene.outline, value("parameter"));
        at = inWorld(flank.point);
        to = times(flank.normal, turn).map(part => -part);
      } else {
        const part = kind === "outer" ? rollers[number] : scene.shafts[number];
        const opening = kind === "outer" ? scene.bores[Math.floor(number / each)] : scene.holes[number];
        to = unit(less(part, inWorld(opening)));
        at = plus(part, to.map(one => one * part[2]));
      }
      found.contacts.push({
        key: `${kind} ${number}`, kind: kind, number: number, name: contactName(kind, number), at: at, to: to, chosen: Boolean(chosen),
        load: load, pressureValue: value("pressure"), width: value("width"),
      });
    }
  }
  return found;
}
