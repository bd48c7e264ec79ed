// SPDX-License-Identifier: BSD-3-Clause
// Unpacks what Pack.cc packed; Pack.hh says how.

const STEPS_PER_DEGREE = 8, GOOD = 255, NO_REASON = 255;

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflate(base64) {
  const stream = new Blob([bytesOf(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads LEB128 numbers one after the other. */
class Numbers {
  constructor(bytes) { this.bytes = bytes; this.at = 0; }
  next() {
    let byte = this.bytes[this.at++];
    if (byte < 128) return byte;
    let value = byte & 127, factor = 128;
    do {
      byte = this.bytes[this.at++];
      value += (byte & 127) * factor;
      factor *= 128;
    } while (byte >= 128);
    return value;
  }
  /** Written as zigzag. */
  nextSigned() {
    const code = this.next();
    return code % 2 === 0 ? code / 2 : -(code + 1) / 2;
  }
}

/**
 * points: 3 numbers of 16 bits a vertex; cells: 4 vertices each, ascending; codes: as in Pack.hh; ids, reasons: of each
 * cell, -1 and NO_REASON where the page does not know; skin: 3 vertices a triangle, those with vertex i as the smallest
 * from skinBegin[i] on; skinCell: the poor cell that a triangle belongs to, or -1.
 */
function unpack(bytes, packed) {
  const streams = {};
  let at = 0;
  for (const [name, size] of Object.entries(packed.sizes)) {
    streams[name] = bytes.subarray(at, at + size);
    at += size;
  }
  const n = packed.vertices;
  const points = new Uint16Array(3 * n);
  for (let axis = 0; axis < 3; ++axis) {
    let last = 0;
    for (let v = 0; v < n; ++v) {
      const code = streams.low[axis * n + v] | (streams.high[axis * n + v] << 8);
      last = (last + (code & 1 ? -((code + 1) >> 1) : code >> 1)) & 65535;
      points[3 * v + axis] = last;
    }
  }
  const linkBegin = new Uint32Array(n + 1);
  const linkCount = new Numbers(streams.link_n);
  for (let v = 0; v < n; ++v) linkBegin[v + 1] = linkBegin[v] + linkCount.next();
  const links = new Uint32Array(linkBegin[n]);
  const link = new Numbers(streams.link);
  for (let v = 0, k = 0; v < n; ++v)
    for (let last = v; k < linkBegin[v + 1]; ++k) last = links[k] = last + 1 + link.next();

  const cells = new Uint32Array(4 * packed.cells);
  const [a, b, c, cellCount] = ["cell_a", "cell_b", "cell_c", "cell_n"].map((name) => new Numbers(streams[name]));
  for (let v = 0, k = 0; v < n; ++v) {
    const begin = linkBegin[v];
    for (let left = cellCount.next(), last = 0; left > 0; --left) {
      last += a.next();
      const second = last + 1 + b.next(), third = second + 1 + c.next();
      cells[k++] = v;
      cells[k++] = links[begin + last];
      cells[k++] = links[begin + second];
      cells[k++] = links[begin + third];
    }
  }
  const codes = streams.angle;
  const ids = new Int32Array(packed.cells).fill(-1);
  const reasons = new Uint8Array(packed.cells).fill(NO_REASON);
  const id = new Numbers(streams.id);
  for (let i = 0, k = 0, last = 0; i < codes.length; ++i) {
    if (codes[i] === GOOD) continue;
    ids[i] = last += id.nextSigned();
    reasons[i] = streams.reason[k++];
  }
  const skin = new Uint32Array(3 * packed.skin);
  const skinBegin = new Uint32Array(n + 1);
  const skinCount = new Numbers(streams.skin_n), corner = new Numbers(streams.skin);
  for (let v = 0, k = 0; v < n; ++v) {
    for (let left = skinCount.next(); left > 0; --left) {
      const second = corner.next(), third = second + 1 + corner.next();
      skin[k++] = v;
      skin[k++] = links[linkBegin[v] + second];
      skin[k++] = links[linkBegin[v] + third];
    }
    skinBegin[v + 1] = k / 3;
  }
  const mesh = { points, cells, codes, ids, reasons, skin, skinBegin, nCells: packed.cells, nVertices: n };
  mesh.skinCell = poorCellsOfSkin(mesh);
  return mesh;
}

/** Corners of the four faces of a cell. */
const FACES = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

function poorCellsOfSkin({ cells, codes, skin, skinBegin }) {
  const owner = new Int32Array(skin.length / 3).fill(-1);
  for (let i = 0; i < codes.length; ++i) {
    if (codes[i] === GOOD) continue;
    for (const [p, q, r] of FACES) {
      const v = cells[4 * i + p];
      for (let t = skinBegin[v]; t < skinBegin[v + 1]; ++t)
        if (skin[3 * t + 1] === cells[4 * i + q] && skin[3 * t + 2] === cells[4 * i + r]) owner[t] = i;
    }
  }
  return owner;
}

/** The cell that a triangle of the skin belongs to; -1 where the page does not have it. */
function cellOfSkin(mesh, t) {
  if (mesh.skinCell[t] >= 0) return mesh.skinCell[t];
  const { cells, skin } = mesh;
  const wanted = [skin[3 * t], skin[3 * t + 1], skin[3 * t + 2]];
  for (let i = 0; i < mesh.nCells; ++i) {
    let found = 0;
    for (let k = 0; k < 4; ++k) found += wanted.includes(cells[4 * i + k]) ? 1 : 0;
    if (found === 3) return i;
  }
  return -1;
}

/** Degrees at the six edges; of the coordinates that are given, without a sign. */
function dihedralAngles(p) {
  const minus = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
  const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const out = [];
  for (const [i, j, k, l] of [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]]) {
    const e = minus(p[j], p[i]);
    const u = cross(e, minus(p[k], p[i])), v = cross(e, minus(p[l], p[i]));
    out.push((Math.atan2(Math.hypot(...cross(u, v)), dot(u, v)) * 180) / Math.PI);
  }
  return out;
}
