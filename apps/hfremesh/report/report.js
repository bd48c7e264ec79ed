// SPDX-License-Identifier: BSD-3-Clause
// Fills the page from its payload, and runs the two views.

const byId = (id) => document.getElementById(id);
const payload = JSON.parse(byId("payload").textContent);
const { report, meshes, moments } = payload;
const SIDES = ["before", "after"];

function showWords() {
  const isRun = report.command === "improve";
  const name = meshes[1].name || meshes[0].name;
  document.title = `${name}: mesh report`;
  byId("title").textContent = isRun ? meshes[0].name : `${meshes[0].name} and ${meshes[1].name}`;
  byId("subtitle").textContent = `${isRun ? "Improved" : "Compared"} by ${report.tool.name} ${report.tool.version}` +
    (isRun ? ` in ${seconds(report.seconds.improve)}, ${report.threads} ${report.threads === 1 ? "thread" : "threads"}` +
      (report.options.dry_run ? "; a dry run, no mesh was written" : `; written to ${meshes[1].name}`) : "");
  const [good, line] = verdict(report);
  const part = (heading, lines) => `<div><h3>${heading}</h3><ul>${lines.map((l) => `<li>${prose(l)}</li>`).join("")}</ul></div>`;
  byId("words").innerHTML = `<p class="verdict ${good ? "good" : "bad"}"><strong>${prose(line)}</strong></p><div class="summary">` +
    part("What was wrong", whatWasWrong(report.before)) + part("What was done", whatWasDone(report)) +
    part("What is left, and why", whatIsLeft(report)) + "</div>";
}

function showCharts() {
  const { before, after } = report;
  const marks = (of) => SIDES.flatMap((kind) => [["min", of(report[kind])[0]], ["max", of(report[kind])[1]]]
    .map(([what, at]) => ({ kind, what, at })));
  byId("all-angles").innerHTML = histogram({ title: "All dihedral angles", before: before.dihedral_histogram,
    after: after.dihedral_histogram, binWidth: 5, highest: 180, tickStep: 30, unit: "all dihedral angles",
    marks: marks((s) => [s.min_dihedral.min, s.max_dihedral]) });
  byId("smallest-angles").innerHTML = histogram({ title: "Smallest dihedral angle of each cell",
    before: before.min_dihedral_histogram, after: after.min_dihedral_histogram, binWidth: 1, highest: 71, tickStep: 10,
    unit: "cells; inverted ones left out", marks: marks((s) => [s.min_dihedral.min, s.min_dihedral.max]) });
  if (moments.length > 0)
    byId("course").innerHTML = course(moments, before.min_dihedral.min, after.min_dihedral.min, report.seconds.improve);
}

function showFigures() {
  const pair = (name, of) => [name, of(report.before), of(report.after)];
  const head = ["", "before", "after"];
  const p = (key) => (s) => degrees(s.min_dihedral.percentiles[key]);
  byId("tables").innerHTML = [
    table("Angles", head, [
      pair("smallest dihedral", (s) => degrees(s.min_dihedral.min)),
      pair("0.1 % of cells are below", p("p0.1")), pair("1 % of cells", p("p1")), pair("5 % of cells", p("p5")),
      pair("25 % of cells", p("p25")), pair("half of the cells", p("p50")),
      pair("largest dihedral", (s) => degrees(s.max_dihedral))]),
    table("Cells", head, [
      pair("cells", (s) => count(s.cells)), pair("vertices", (s) => count(s.vertices)),
      pair("inverted", (s) => count(s.inverted)), pair("flat", (s) => count(s.flat)),
      ...[5, 10, 15, 20, 30].map((d) => pair(`below ${d}°`, (s) => s.cells_below[d] === 0 ? "0" : `${count(s.cells_below[d])} (${share(s.cells_below[d], s.cells)})`)),
      pair("boundary faces", (s) => count(s.boundary_faces)), pair("volume", (s) => s.volume.toPrecision(6))]),
  ].map((t) => `<div class="scroll">${t}</div>`).join("");
}

function showTime() {
  if (!report.passes || report.passes.length === 0) return;
  const by = (key) => {
    const groups = new Map();
    for (const pass of report.passes) {
      const g = groups.get(pass[key]) || { seconds: 0, passes: 0, seeds: 0, winners: 0 };
      g.seconds += pass.seconds.total;
      g.passes += 1;
      g.seeds += pass.seeds;
      g.winners += pass.winners;
      groups.set(pass[key], g);
    }
    return [...groups].sort((a, b) => b[1].seconds - a[1].seconds);
  };
  const rows = (groups) => {
    const most = Math.max(1e-9, ...groups.map(([, g]) => g.seconds));
    return groups.map(([name, g]) => [name, seconds(g.seconds), count(g.passes), count(g.seeds), count(g.winners),
      { html: `<span class="share" style="width:${((100 * g.seconds) / most).toFixed(1)}px"></span>` }]);
  };
  const head = ["", "time", "passes", "looked at", "changed", ""];
  byId("time-tables").innerHTML = ["op", "stage"].map((key) =>
    `<div class="scroll">${table(key === "op" ? "By operator" : "By stage", head, rows(by(key)))}</div>`).join("");
  byId("time").hidden = false;
}

function showStuck() {
  const groups = new Map();
  meshes[1].cells.forEach((cell, i) => {
    const key = cell.limit || "";
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push({ ...cell, place: i });
  });
  const row = (cell) => [String(cell.cell), degrees(cell.degrees), cell.ceiling === undefined ? "" : degrees(cell.ceiling),
    cell.frozen_vertices === undefined ? "" : `${cell.frozen_vertices} of 4`, cell.degrees > 0 ? degrees(Math.max(...cell.angles)) : "–",
    { html: `<button type="button" data-place="${cell.place}" aria-label="Show cell ${cell.cell} in the view">show</button>` }];
  const head = ["cell", "smallest", "at most", "held vertices", "largest", ""];
  byId("stuck-heading").textContent = groups.has("") ? "Poorest cells of the mesh after" : "Cells that are left, by reason";
  byId("stuck-lists").innerHTML = groups.size === 0 ? "<p>None.</p>" : [...groups].map(([reason, cells]) => {
    const all = reason && report.limits ? report.limits.counts[reason] : cells.length;
    const words = REASONS[reason] ? `<p>${prose(REASONS[reason][0][0].toUpperCase() + whyAndWhat(reason, report.options).slice(1))}</p>` : "";
    const more = all > cells.length ? `<p class="hint">The worst ${cells.length} of ${count(all)}; <code>--ids</code> lists all.</p>` : "";
    return `<details ${cells.length <= 20 ? "open" : ""}><summary>${escapeText(reason || "the poorest")}: ${some(all, "cell", "cells")}</summary>` +
      `${words}${more}<div class="scroll">${table("", head, cells.map(row))}</div></details>`;
  }).join("");
  byId("stuck-lists").addEventListener("click", (event) => {
    const place = event.target.dataset.place;
    if (place !== undefined && app.views) app.find(1, meshes[1].cells[place]);
  });
}

function showParts() {
  const joined = (of, key) => {
    const rows = new Map();
    SIDES.forEach((side, i) => of(report[side]).forEach((item) => {
      if (!rows.has(item[key])) rows.set(item[key], [{}, {}]);
      rows.get(item[key])[i] = item;
    }));
    return [...rows].sort((a, b) => a[0] - b[0]);
  };
  const either = (x, show) => (x === undefined || x === null ? "–" : show(x));
  const most = 60;
  const cut = (rows) => (rows.length > most ? [...rows.slice(0, most), [`${rows.length - most} more`]] : rows);
  const regions = joined((s) => s.regions, "region").map(([region, [b, a]]) => [String(region), either(b.cells, count), either(a.cells, count),
    either(b.min_dihedral, degrees), either(a.min_dihedral, degrees), either(a.volume, (v) => v.toPrecision(5))]);
  const patches = joined((s) => s.patches, "label").map(([label, [b, a]]) => [label === 0 ? "0 (no label)" : String(label), either(b.faces, count),
    either(a.faces, count), either(b.area, (v) => v.toPrecision(5)), either(a.area, (v) => v.toPrecision(5))]);
  byId("part-tables").innerHTML =
    `<div class="scroll">${table("Regions", ["region", "cells before", "after", "worst before", "after", "volume"], cut(regions))}</div>` +
    `<div class="scroll">${table("Patches of the surface", ["label", "faces before", "after", "area before", "after"], cut(patches))}</div>`;
}

function showNotes() {
  const notes = report.notes || [];
  byId("note-list").innerHTML = notes.map((note) => `<li>${prose(note)}</li>`).join("");
  byId("notes").hidden = notes.length === 0;
  byId("footer").textContent = "Angles are dihedral angles in degrees; numbers of cells count from 0. Figures are those of the JSON " +
    "report of the same run; coordinates in the views are rounded to 1/65,536 of the bounding box.";
}

/** The two views and what they share. */
const app = {
  views: null, camera: null, picked: [-1, -1], asked: false, stale: {},
  state: { limit: 15, opacity: 1, floating: true, axis: 1, at: 0.5, beyond: 1 },

  async start() {
    if (typeof DecompressionStream === "undefined") throw new Error("DecompressionStream is missing");
    const boxes = meshes.map((m) => m.packed);
    const low = [0, 1, 2].map((i) => Math.min(...boxes.map((b) => b.low[i])));
    const high = [0, 1, 2].map((i) => Math.max(...boxes.map((b) => b.high[i])));
    const frame = { low, high, centre: scaled(0.5, added(low, high)), radius: 0.5 * Math.hypot(...subtract(high, low)) || 1 };
    this.frame = frame;
    this.camera = new Camera(subtract(high, low));
    Object.assign(this.state, { axis: this.camera.frontAxis, beyond: this.camera.side });
    const packs = await Promise.all([0, 1].map((i) => inflate(byId(`mesh-${i}`).textContent)));
    this.views = packs.map((bytes, i) => new MeshView(byId(`canvas-${i}`), unpack(bytes, meshes[i].packed), meshes[i].packed, frame));
    this.camera.fit(this.views.flatMap((view) => view.outline()), this.aspect());
    this.stale = { limit: true, cut: true };
    byId("axis").value = String(this.state.axis);
    this.listen();
    this.draw();
  },

  /** Of the views, width by height. */
  aspect() { return byId("canvas-0").clientWidth / Math.max(1, byId("canvas-0").clientHeight); },
  colours() {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches && !this.printing;
    const of = (hex) => [hex >> 16 & 255, hex >> 8 & 255, hex & 255].map((c) => c / 255);
    return dark ? { paper: of(0x1d242c), surface: of(0x8c9fb4), inside: of(0xc9d2dc), edge: of(0x101820) }
      : { paper: of(0xf5f7f9), surface: of(0xc3d0df), inside: of(0xeef1f5), edge: of(0x33475e) };
  },
  draw() {
    this.asked = false;
    this.update();
    const colours = this.colours();
    this.views.forEach((view) => view.draw(this.camera, this.state, colours));
  },
  /** Once a frame, however often it is asked for. */
  ask() {
    if (!this.asked) requestAnimationFrame(() => this.draw());
    this.asked = true;
  },
  /** What of the meshes is on the device, where a control has asked for other cells. */
  update() {
    if (this.stale.limit) this.views.forEach((view) => view.setLimit(this.state.limit));
    if (this.stale.cut) this.setCut();
    this.stale = {};
  },
  setCut() {
    const { axis, at, beyond } = this.state;
    const { low, high } = this.frame;
    const place = axis < 0 ? 0 : low[axis] + at * (high[axis] - low[axis]);
    this.views.forEach((view) => view.setCut(axis, place, beyond));
    byId("cut-out").textContent = axis < 0 ? "–" : place.toPrecision(3);
  },
  pickAt(side, x, y) {
    const cell = this.views[side].pick(x, y, this.camera, this.state);
    this.select(side, cell);
  },
  select(side, cell) {
    this.picked = [-1, -1];
    this.picked[side] = cell;
    this.views.forEach((view, i) => view.setPicked(this.picked[i]));
    byId("picked").textContent = cell < 0 ? "No cell there." : this.wordsOf(side, cell);
    this.ask();
  },
  wordsOf(side, cell) {
    const view = this.views[side];
    const { ids, codes, reasons } = view.mesh;
    const id = ids[cell], code = codes[cell];
    const known = id >= 0 ? meshes[side].cells.find((c) => c.cell === id) : undefined;
    const angles = (known ? known.angles : dihedralAngles(view.cornersOf(cell))).slice().sort((a, b) => a - b);
    const name = id >= 0 ? `Cell ${id}` : "A cell of 30° or more, whose number this page does not keep,";
    const state = code === 0 ? "is inverted or flat" : known ? `has a smallest dihedral of ${degrees(known.degrees)}`
      : code < GOOD ? `has a smallest dihedral of about ${((code - 0.5) / STEPS_PER_DEGREE).toFixed(1)}°` : "is a good one";
    const reason = known && known.limit ? known.limit : reasons[cell] !== NO_REASON ? payload.reasons[reasons[cell]] : "";
    return `${SIDES[side]}: ${name} ${state}. Dihedral angles${known ? "" : " (from rounded coordinates)"}: ` +
      `${angles.map((a) => `${a.toFixed(1).replace("-", "−")}°`).join(", ")}.` +
      (reason ? ` Why it is left: ${REASONS[reason] ? REASONS[reason][0] : reason} (${reason}).` : "");
  },
  /** Brings a cell of the lists before the eye, with the cut through it. */
  find(side, cell) {
    const middle = scaled(0.25, cell.points.reduce(added));
    const size = Math.max(...cell.points.map((p) => Math.hypot(...subtract(p, middle))));
    this.camera.target = scaled(1 / this.frame.radius, subtract(middle, this.frame.centre));
    this.camera.distance = Math.max(0.02, Math.min(3.4, (14 * size) / this.frame.radius));
    const { axis } = this.state;
    if (axis >= 0) {
      const extent = this.frame.high[axis] - this.frame.low[axis];
      this.state.at = (middle[axis] - this.frame.low[axis]) / (extent || 1);
      byId("cut").value = String(this.state.at);
      this.setCut();
    }
    const { ids } = this.views[side].mesh;
    const known = ids.indexOf(cell.cell);
    const index = known >= 0 ? known : this.views[side].cellAt(middle);
    ids[index] = cell.cell;
    this.select(side, index);
    byId("view").scrollIntoView({ behavior: "smooth", block: "start" });
  },

  listen() {
    const { state } = this;
    const on = (id, event, act) => byId(id).addEventListener(event, (e) => { act(e.target); this.ask(); });
    on("limit", "input", (input) => {
      state.limit = Number(input.value);
      byId("limit-out").textContent = `${state.limit}°`;
      this.stale.limit = true;
      this.legend();
    });
    on("cut", "input", (input) => { state.at = Number(input.value); this.stale.cut = true; });
    on("axis", "change", (select) => { state.axis = select.value === "none" ? -1 : Number(select.value); this.stale.cut = true; });
    on("flip", "change", (box) => { state.beyond = this.camera.side * (box.checked ? -1 : 1); this.stale.cut = true; });
    on("opacity", "input", (input) => { state.opacity = Number(input.value); byId("opacity-out").textContent = `${Math.round(100 * state.opacity)} %`; });
    on("float", "change", (box) => { state.floating = box.checked; });
    on("reset", "click", () => this.camera.reset(this.aspect()));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.ask());
    window.addEventListener("beforeprint", () => { this.printing = true; this.draw(); });
    window.addEventListener("afterprint", () => { this.printing = false; this.draw(); });
    const resized = new ResizeObserver(() => this.ask());
    this.views.forEach((view, side) => { resized.observe(view.canvas); this.steer(view.canvas, side); });
    this.legend();
  },
  legend() {
    byId("legend").innerHTML = `0°<span class="ramp"></span>${this.state.limit}°<span class="together"><span class="swatch"></span> inverted or flat, always shown</span>`;
  },
  steer(canvas, side) {
    let last = null, moved = 0;
    canvas.addEventListener("pointerdown", (e) => { last = [e.clientX, e.clientY]; moved = 0; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", (e) => {
      if (!last) return;
      const dx = e.clientX - last[0], dy = e.clientY - last[1];
      moved += Math.abs(dx) + Math.abs(dy);
      last = [e.clientX, e.clientY];
      if (e.shiftKey || e.buttons === 4) this.camera.shift((0.8 * dx) / canvas.clientHeight, (0.8 * dy) / canvas.clientHeight);
      else this.camera.rotate((4 * dx) / canvas.clientHeight, (4 * dy) / canvas.clientHeight);
      this.ask();
    });
    canvas.addEventListener("pointerup", () => { last = null; });
    canvas.addEventListener("click", (e) => { if (moved < 4) this.pickAt(side, e.offsetX, e.offsetY); });
    canvas.addEventListener("pointercancel", () => { last = null; });
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.camera.zoom(Math.exp(0.0012 * e.deltaY)); this.ask(); }, { passive: false });
    canvas.addEventListener("keydown", (e) => {
      const step = 0.12;
      const act = {
        ArrowLeft: () => this.camera.rotate(step, 0), ArrowRight: () => this.camera.rotate(-step, 0),
        ArrowUp: () => this.camera.rotate(0, step), ArrowDown: () => this.camera.rotate(0, -step),
        "+": () => this.camera.zoom(0.85), "=": () => this.camera.zoom(0.85), "-": () => this.camera.zoom(1.18),
        0: () => this.camera.reset(this.aspect()),
      }[e.key];
      if (!act) return;
      e.preventDefault();
      act();
      this.ask();
    });
  },
};

function captions() {
  SIDES.forEach((side, i) => {
    const { cells, all_cells: whole } = meshes[i].packed;
    byId(`caption-${i}`).textContent = `${side}: ${meshes[i].name}, ${some(report[side].cells, "cell", "cells")}` +
      (whole ? "" : `; of these the ${count(cells)} poorest are in this page, which would be too large with all`);
  });
}

function withoutView(error) {
  byId("no-view").hidden = false;
  byId("no-view").textContent = `There is no 3-D view here: ${error.message}. Everything else of this page is complete.`;
  byId("canvases").hidden = byId("controls").hidden = byId("view-hint").hidden = true;
}

/** On paper the lists of cells are open. */
function openForPrint() {
  let closed = [];
  window.addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("#stuck details:not([open])")];
    for (const list of closed) list.open = true;
  });
  window.addEventListener("afterprint", () => { for (const list of closed) list.open = false; });
}

/** A table that is wider than its place can be moved by the arrow keys, too. */
function reachTables() {
  const look = (tables) => tables.forEach(({ target: t }) => {
    if (t.scrollWidth > t.clientWidth) t.tabIndex = 0;
    else t.removeAttribute("tabindex");
  });
  const resized = new ResizeObserver(look);
  document.querySelectorAll(".scroll").forEach((t) => resized.observe(t));
}

matchMedia("(max-width: 560px)").addEventListener("change", () => { showCharts(); reachTables(); });
for (const show of [showWords, showCharts, showFigures, showTime, showStuck, showParts, showNotes, captions, openForPrint, reachTables]) show();
window.ready = app.start().catch(withoutView).then(() => { document.documentElement.dataset.ready = app.views ? "view" : "text"; });
