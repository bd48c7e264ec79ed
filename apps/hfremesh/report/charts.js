// SPDX-License-Identifier: BSD-3-Clause
// Charts as SVG text, and tables. Colours are those of report.css, so that they follow dark mode and print.

const escapeText = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

/** Text in which names of options are set as code, so that no line ends within one. */
const prose = (text) => escapeText(text).replace(/--[a-z][a-z-]*/g, "<code>$&</code>");

/** About `n` round numbers from 0 to `highest`. */
function ticks(highest, n) {
  if (!(highest > 0)) return [0];
  const rough = highest / n;
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * [1, 2, 5, 10].find((f) => f * unit >= rough);
  const out = [];
  for (let i = 0; i * step <= highest * 1.0001; ++i) out.push(Number((i * step).toPrecision(6)));
  return out;
}

/** Where charts are drawn with fewer units, so that their text can be read. */
const isNarrow = () => matchMedia("(max-width: 560px)").matches;

const sum = (list) => list.reduce((a, b) => a + b, 0);

/**
 * Two histograms in one: after as bars, before as a line, both as shares of their mesh.
 * marks: [{at, kind: "before" | "after", text}].
 */
function histogram({ title, before, after, binWidth, highest, tickStep, marks, unit }) {
  const W = isNarrow() ? 400 : 600, H = 300, left = 52, right = 22, top = 44, bottom = 44;
  const x = (value) => left + ((W - left - right) * value) / highest;
  const shares = [before, after].map((bins) => bins.map((n) => (100 * n) / Math.max(1, sum(bins))));
  const peak = Math.max(...shares[0], ...shares[1], 1e-9);
  const y = (percent) => H - bottom - ((H - top - bottom) * percent) / peak;
  const parts = [];
  for (const t of ticks(peak, 4)) {
    parts.push(`<line class="grid" x1="${left}" x2="${W - right}" y1="${y(t)}" y2="${y(t)}"/>`);
    parts.push(`<text x="${left - 6}" y="${y(t) + 4}" text-anchor="end">${t} %</text>`);
  }
  shares[1].forEach((s, i) => {
    if (s <= 0) return;
    const height = Math.max(1, H - bottom - y(s));
    parts.push(`<rect class="bar-after" x="${(x(i * binWidth) + 0.5).toFixed(1)}" width="${(x(binWidth) - x(0) - 1).toFixed(1)}" ` +
      `y="${(H - bottom - height).toFixed(1)}" height="${height.toFixed(1)}"/>`);
  });
  const path = shares[0].map((s, i) => `${i === 0 ? "M" : "L"}${x(i * binWidth).toFixed(1)} ${y(s).toFixed(1)}H${x((i + 1) * binWidth).toFixed(1)}`);
  parts.push(`<path class="line-before" d="${path.join("")}"/>`);
  for (let t = 0; t <= highest; t += tickStep)
    parts.push(`<line class="axis" x1="${x(t)}" x2="${x(t)}" y1="${H - bottom}" y2="${H - bottom + 5}"/>` +
      `<text x="${x(t)}" y="${H - bottom + 20}" text-anchor="middle">${t}°</text>`);
  parts.push(`<line class="axis" x1="${left}" x2="${W - right}" y1="${H - bottom}" y2="${H - bottom}"/>`);
  for (const mark of marks) {
    const at = x(Math.min(highest, Math.max(0, mark.at)));
    parts.push(`<line class="mark-${mark.kind}" x1="${at}" x2="${at}" y1="${top - 6}" y2="${H - bottom}"/>`);
  }
  const words = (kind, baseline) => {
    const [low, high] = ["min", "max"].map((what) => marks.find((m) => m.kind === kind && m.what === what));
    const put = (m, where, anchor) => m ? `<text class="text-${kind}" x="${where}" y="${baseline}" text-anchor="${anchor}">${m.what} ${degrees(m.at)}</text>` : "";
    return put(low, left, "start") + put(high, W - right, "end");
  };
  parts.push(words("before", 18), words("after", 34));
  const label = `${title}. ${marks.map((m) => `${m.kind}: ${m.what} ${degrees(m.at)}`).join("; ")}. The counts are in the table below.`;
  const rows = before.map((n, i) => (n + after[i] > 0 ? [`${i * binWidth}° to ${(i + 1) * binWidth}°`, count(n), count(after[i])] : null)).filter(Boolean);
  return `<h3>${escapeText(title)}</h3><svg viewBox="0 0 ${W} ${H}" role="img" aria-label="${escapeText(label)}">${parts.join("")}</svg>` +
    `<p class="key"><span class="before"><i></i>before</span><span class="after"><i></i>after</span><span>share of ${unit}</span></p>` +
    `<details><summary>Counts</summary><div class="scroll">${table("", ["angle", "before", "after"], rows)}</div></details>`;
}

/** The worst angle against time, with the stages named: a band each, and the name where there is room. */
function course(moments, first, last, total) {
  const W = isNarrow() ? 420 : 1200, H = 320, left = 56, right = 20, top = 58, bottom = 40;
  const points = [{ seconds: 0, degrees: first, stage: "", inverted: 0 }, ...moments];
  const end = Math.max(total, points[points.length - 1].seconds, 1e-9);
  points.push({ seconds: end, degrees: last, stage: "", inverted: 0 });
  const low = Math.min(0, ...points.map((p) => p.degrees)), high = Math.max(1, ...points.map((p) => p.degrees));
  const x = (t) => left + ((W - left - right) * t) / end;
  const y = (d) => H - bottom - ((H - top - bottom) * (d - low)) / (high - low);
  const parts = [];
  const bands = [];
  for (const p of moments) {
    const open = bands[bands.length - 1];
    if (open && open.stage === p.stage) open.to = p.seconds;
    else bands.push({ stage: p.stage, from: open ? open.to : 0, to: p.seconds });
  }
  let free = [0, 0];
  bands.forEach((band, i) => {
    if (i % 2 === 0)
      parts.push(`<rect class="band" x="${x(band.from).toFixed(1)}" width="${(x(band.to) - x(band.from)).toFixed(1)}" y="${top - 8}" height="${H - top - bottom + 8}"/>`);
    const middle = (x(band.from) + x(band.to)) / 2, half = 3.6 * band.stage.length;
    const row = free.findIndex((taken) => middle - half >= taken);
    if (row < 0) return;
    free[row] = middle + half + 8;
    parts.push(`<text x="${Math.max(left + half, Math.min(W - right - half, middle)).toFixed(1)}" y="${row === 0 ? 22 : 42}" text-anchor="middle">${escapeText(band.stage)}</text>`);
  });
  for (const t of ticks(high, 5).filter((t) => t >= low))
    parts.push(`<line class="grid" x1="${left}" x2="${W - right}" y1="${y(t)}" y2="${y(t)}"/><text x="${left - 6}" y="${y(t) + 4}" text-anchor="end">${t}°</text>`);
  if (low < 0) parts.push(`<text x="${left - 6}" y="${y(low) + 4}" text-anchor="end">${low.toFixed(0).replace("-", "−")}°</text>`);
  for (const t of ticks(end, isNarrow() ? 3 : 8)) parts.push(`<text x="${x(t)}" y="${H - bottom + 20}" text-anchor="middle">${t} s</text>`);
  parts.push(`<line class="axis" x1="${left}" x2="${W - right}" y1="${y(low)}" y2="${y(low)}"/>`);
  const path = points.map((p, i) => (i === 0 ? `M${x(p.seconds).toFixed(1)} ${y(p.degrees).toFixed(1)}` : `H${x(p.seconds).toFixed(1)}V${y(p.degrees).toFixed(1)}`));
  parts.push(`<path class="line-after" d="${path.join("")}"/>`);
  const rows = moments.map((m) => [seconds(m.seconds), m.stage, m.iteration, degrees(m.degrees), count(m.inverted)]);
  const label = `Worst dihedral angle against time: from ${degrees(first)} to ${degrees(last)} in ${seconds(end)}; stages: ${[...new Set(bands.map((b) => b.stage))].join(", ")}.`;
  return `<h3>The worst angle in the course of the run</h3><svg viewBox="0 0 ${W} ${H}" role="img" aria-label="${escapeText(label)}">${parts.join("")}</svg>` +
    `<details><summary>Values</summary><div class="scroll">${table("", ["time", "stage", "iteration", "worst angle", "inverted"], rows)}</div></details>`;
}

/** Cells are text; a cell that is {html} is put in as it is. */
function table(caption, head, rows) {
  const cell = (tag, value, extra = "") => `<${tag}${extra}>${value && value.html !== undefined ? value.html : escapeText(value ?? "")}</${tag}>`;
  const body = rows.map((row) => `<tr>${row.map((value, i) => (i === 0 ? cell("th", value, ' scope="row"') : cell("td", value, value && value.text ? ' class="text"' : ""))).join("")}</tr>`);
  return `<table>${caption ? `<caption>${escapeText(caption)}</caption>` : ""}<thead><tr>${head.map((h) => cell("th", h, ' scope="col"')).join("")}</tr></thead><tbody>${body.join("")}</tbody></table>`;
}
