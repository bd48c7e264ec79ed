// SPDX-License-Identifier: BSD-3-Clause
// What was wrong, what was done, what is left, in sentences.

const count = (n) => n.toLocaleString("en-US");
const some = (n, one, many) => `${count(n)} ${n === 1 ? one : many}`;
const degrees = (x) => `${x.toFixed(2).replace("-", "−")}°`;
const seconds = (s) => (s < 1 ? `${(1000 * s).toFixed(0)} ms` : s < 100 ? `${s.toFixed(1)} s` : `${(s / 60).toFixed(1)} min`);
const share = (part, all) => {
  const percent = all > 0 ? (100 * part) / all : 0;
  return percent < 0.01 ? "less than 0.01 %" : `${percent < 1 ? percent.toPrecision(1) : percent < 9.95 ? percent.toPrecision(2) : Math.round(percent)} %`;
};

/** What keeps a cell from getting better, and what would help. */
const REASONS = {
  "folded surface": ["the surface lies on or goes through itself there",
    "Every mesh with this surface has an inverted or flat cell at this place. The surface has to change: mend it, or let " +
    "the run unfold it with --surface free."],
  "surface ceiling": ["two faces of the surface leave too narrow a wedge",
    "While the surface is frozen no mesh has a larger angle there. With --surface flat or free the surface may change; a " +
    "sharp feature of the shape stays sharp."],
  "input feature": ["an interface between regions or a labelled face leaves too narrow a wedge",
    "The faces are kept because they were labelled or separate regions. --ignore-labels leaves out labels that need not stay."],
  "surface feature": ["a feature of the surface leaves too narrow a wedge",
    "The surface may change, but a sharp edge of it has to stay. The shape itself is narrower than the angle."],
  "max cells": ["a new vertex would help, and the bound on the number of cells leaves no room for it",
    "A larger --max-cells allows it."],
  "time limit": ["the time was up", "A larger --time-limit, or none, lets the run go on."],
  "cancelled": ["the run was cancelled", "Run it to its end."],
  "iterations": ["the number of iterations was bounded", "A larger --iterations, or none, lets the run go on."],
  "device lost": ["the device failed", "Run it again, on the processor: --device cpu."],
  "not found": ["nothing better was found, which proves nothing", ""],
};

/** What would help against a reason, in a run with these options. */
function adviceOn(reason, options) {
  if (reason !== "not found") return REASONS[reason] ? REASONS[reason][1] : "";
  const more = [];
  if (options.min_dihedral !== "max") more.push("more effort (--min-dihedral max)");
  if (options.surface === "frozen") more.push("a surface that may change (--surface flat, free)");
  const words = more.join(" or ");
  return words ? `${words[0].toUpperCase()}${words.slice(1)} may find something.` : "";
}

/** The reason and the advice as sentences. */
function whyAndWhat(reason, options) {
  const why = REASONS[reason] ? REASONS[reason][0] : reason;
  return `${why}. ${adviceOn(reason, options)}`.trim();
}

const STOPS = {
  "goal": "It ended because its goal was reached.",
  "no progress": "It ended because nothing more could be gained with its effort.",
  "iterations": "It ended at the number of iterations that was asked for.",
  "time limit": "It ended because its time was up.",
  "cancelled": "It was cancelled; the mesh is the best so far.",
  "device lost": "The device failed; the mesh is that of the last finished round.",
};

const OPERATORS = {
  edge: "edges taken out", face: "faces swapped or taken out", node: "vertices taken out", smooth: "moves of vertices",
  insert: "vertices put in", cluster: "clusters built anew", mixed: "edges, faces or vertices taken out",
  unfold: "moves of vertices out of folds", surface: "changes of the surface",
};

function whatWasWrong(s) {
  const lines = [];
  if (s.inverted > 0)
    lines.push(`${some(s.inverted, "cell is", "cells are")} inverted: the volume is negative, and a solver that meets such ` +
      "a cell fails or gives a wrong answer.");
  if (s.flat > 0) lines.push(`${some(s.flat, "cell is", "cells are")} flat: the volume is zero but for rounding.`);
  const poor = s.cells_below["15"];
  if (poor > 0)
    lines.push(`${some(poor, "cell", "cells")} (${share(poor, s.cells)}) ${poor === 1 ? "has" : "have"} a dihedral angle ` +
      "below 15°. Such cells make a solver's matrices ill-conditioned and its time steps short.");
  if (s.max_dihedral > 165)
    lines.push(`The largest dihedral angle is ${degrees(s.max_dihedral)}. Gradients in cells with angles near 180° are wrong.`);
  if (lines.length === 0) lines.push("Nothing that a solver would trip over: every cell is valid, and none has a dihedral angle below 15°.");
  lines.push(`The smallest dihedral angle is ${degrees(s.min_dihedral.min)}; half of the cells have one below ` +
    `${degrees(s.min_dihedral.percentiles.p50)}. The regular tetrahedron has 70.53°.`);
  return lines;
}

function whatWasDone(report) {
  const { before, after, options, passes, result } = report;
  const lines = [];
  if (!passes) {
    lines.push("This page compares two files. How the second was made is not known to it.");
  } else {
    const goal = options.compat ? `the published pipeline ${options.compat}`
      : options.min_dihedral === "max" ? "the largest worst angle that can be had, at any cost in time"
      : options.min_dihedral ? `a smallest dihedral angle of ${options.min_dihedral}° in every cell`
      : "valid cells first, then better angles everywhere";
    lines.push(`The run worked for ${goal}.`);
    lines.push({ frozen: "The surface was frozen: every triangle of it is what it was.",
      flat: "The surface kept its shape; flat parts of it may have other triangles.",
      free: "The surface could move within its bound." }[options.surface] || "");
    const stages = new Set(passes.map((pass) => pass.stage));
    stages.delete("undo");
    const done = new Map();
    for (const pass of passes) {
      const op = pass.op.startsWith("surface") ? "surface" : pass.op;
      done.set(op, (done.get(op) || 0) + pass.winners);
    }
    const named = [...done].filter(([op, n]) => n > 0 && op !== "undo")
      .sort((a, b) => b[1] - a[1]).slice(0, 6).map(([op, n]) => `${count(n)} ${OPERATORS[op] || `times ${op}`}`);
    if (passes.length > 0)
      lines.push(`${some(passes.length, "pass", "passes")} in ${some(stages.size, "stage", "stages")} took ` +
        `${seconds(report.seconds.improve)}${named.length > 0 ? `: ${named.join(", ")}` : " and found nothing to improve"}.`);
    if (passes.some((pass) => pass.op === "undo"))
      lines.push("Some passes were taken back, because they had made the mesh worse in the end.");
    lines.push(result.changed || !result.goal_reached ? STOPS[result.stop] : "Nothing had to be changed: the mesh is what it was.");
  }
  const change = before.cells > 0 ? 100 * (after.cells / before.cells - 1) : 0;
  lines.push(`The mesh has ${count(after.cells)} cells, ${count(before.cells)} before (${change >= 0 ? "+" : "−"}` +
    `${Math.abs(change).toFixed(1)} %), and ${count(after.vertices)} vertices, ${count(before.vertices)} before.`);
  return lines.filter((line) => line);
}

function whatIsLeft(report) {
  const { after, limits } = report;
  const lines = [];
  const invalid = after.inverted + after.flat;
  if (invalid > 0)
    lines.push(`${some(invalid, "cell is", "cells are")} still inverted or flat. A solver cannot take this mesh.`);
  else lines.push("Every cell is valid.");
  lines.push(`The smallest dihedral angle is ${degrees(after.min_dihedral.min)}, the largest ${degrees(after.max_dihedral)}; ` +
    `${after.cells_below["15"] > 0 ? some(after.cells_below["15"], "cell has", "cells have") : "no cell has"} one below 15°.`);
  if (limits && limits.n_cells > 0) {
    lines.push(`${some(limits.n_cells, "cell is", "cells are")} below ${limits.below}°, ` +
      (report.options.min_dihedral > 0 ? "which was the goal." : "the first angle that the worst cells were raised to in vain."));
    for (const [reason, n] of Object.entries(limits.counts))
      if (n > 0) {
        const which = n === limits.n_cells ? "Why" : `${count(n)} of them`;
        lines.push(`${which}: ${whyAndWhat(reason, report.options)}`);
      }
    const held = limits.held_by_surface;
    if (held && held.cells > 0 && held.flat !== undefined && held.flat + held.free > 0)
      lines.push(`The frozen surface has a part in ${count(held.cells)} of them: --surface flat would let it change at ` +
        `${count(held.flat)}, free at ${count(held.free)} more.`);
  }
  return lines;
}

function verdict(report) {
  const { before, after } = report;
  const from = before.min_dihedral.min, to = after.min_dihedral.min;
  const invalidBefore = before.inverted + before.flat, invalid = after.inverted + after.flat;
  const worst = from === to ? `the smallest dihedral angle is what it was, ${degrees(to)}`
    : `the smallest dihedral angle went from ${degrees(from)} to ${degrees(to)}`;
  if (invalid > 0) return [false, `${some(invalid, "cell is", "cells are")} still inverted or flat (${count(invalidBefore)} before); ${worst}.`];
  const goal = report.options && report.options.min_dihedral;
  if (goal > 0 && !report.result.goal_reached)
    return [false, `${some(report.limits.n_cells, "cell misses", "cells miss")} the goal of ${goal}°; ${worst}.`];
  if (invalidBefore > 0) return [true, `All ${count(invalidBefore)} inverted or flat cells are mended; ${worst}.`];
  if (to > from) return [true, `The mesh is better: ${worst}.`];
  if (to === from) return [true, `The worst angle is what it was, ${degrees(to)}.`];
  return [false, `The worst angle is lower: ${worst}.`];
}
