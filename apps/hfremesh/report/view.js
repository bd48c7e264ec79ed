// SPDX-License-Identifier: BSD-3-Clause
// The view of a mesh by WebGL 2: surface, cut, poor cells. Whole cells are kept or left out, never cut through: a cell
// stays while one of its vertices is on the near side of the cutting plane.

const VERTEX_SHADER = `#version 300 es
in vec4 corner;                       // x, y, z of 16 bits, and the code of the angle
uniform mat4 matrix;
uniform vec3 low, unit;
out vec3 at, weight;
flat out float code;
flat out int triangle;
void main() {
  at = low + corner.xyz * unit;
  code = corner.w;
  int i = gl_VertexID % 3;
  triangle = gl_VertexID / 3;
  weight = vec3(i == 0, i == 1, i == 2);
  gl_Position = matrix * vec4(at, 1.0);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
precision highp int;
in vec3 at, weight;
flat in float code;
flat in int triangle;
uniform float limit, opacity;         // degrees; of the triangles
uniform vec3 others, edge, towardsEye, up, right;
uniform int first;                    // number of the first triangle, where picking is on; -1 otherwise
uniform float edgeOpacity;
out vec4 colour;
vec3 ramp(float t) {
  vec3 a = vec3(0.478, 0.0, 0.133), b = vec3(0.784, 0.118, 0.118), c = vec3(0.957, 0.439, 0.122),
       d = vec3(0.992, 0.702, 0.22), e = vec3(1.0, 0.906, 0.58);
  float s = clamp(t, 0.0, 1.0) * 4.0;
  return s < 1.0 ? mix(a, b, s) : s < 2.0 ? mix(b, c, s - 1.0) : s < 3.0 ? mix(c, d, s - 2.0) : mix(d, e, s - 3.0);
}
void main() {
  if (first >= 0) {
    int id = first + triangle + 1;
    colour = vec4(float(id & 255), float((id >> 8) & 255), float((id >> 16) & 255), float((id >> 24) & 255)) / 255.0;
    return;
  }
  float degrees = (code - 1.0) / 8.0;
  vec3 base = code < 0.5 ? vec3(0.416, 0.0, 0.847) : code < 254.5 && degrees < limit ? ramp(degrees / limit) : others;
  vec3 n = normalize(cross(dFdx(at), dFdy(at)));
  if (dot(n, towardsEye) < 0.0) n = -n;
  float light = max(0.0, dot(n, normalize(-0.36 * right + 0.52 * up + 0.775 * towardsEye)));
  base *= 0.64 + 0.38 * light;
  vec3 step = max(fwidth(weight), vec3(1e-9));
  float height = 1.0 / max(step.x, max(step.y, step.z));           // of the triangle, in pixels
  float nearest = min(weight.x / step.x, min(weight.y / step.y, weight.z / step.z));
  float line = (1.0 - smoothstep(0.35, 1.1, nearest)) * clamp((height - 3.0) / 9.0, 0.0, 1.0) * edgeOpacity;
  colour = vec4(mix(base, edge, line), max(opacity, line * opacity));
}`;

const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const crossed = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
const added = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const inner = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Eye of both views. Lengths are in radii of the box of both meshes, about its middle. */
class Camera {
  /** z is up, unless the box is flat in it; the eye is on the side where the box is wide. */
  constructor(extent) {
    this.up = extent[2] < 0.5 * Math.min(extent[0], extent[1]) ? 1 : 2;
    const other = this.up === 2 ? 1 : 2;
    const axis = (i) => [0, 1, 2].map((k) => (k === i ? 1 : 0));
    this.right = extent[0] >= extent[other] ? 0 : other;
    this.frontAxis = 3 - this.up - this.right;
    this.base = [axis(this.right), axis(this.up), crossed(axis(this.right), axis(this.up))];
    /** +1 where the eye is on the side of larger coordinates. */
    this.side = Math.sign(this.base[2][this.frontAxis]);
    this.outline = [[0, 0, 0]];
  }
  /** From here on the first view is the nearest one that these points are seen from. */
  fit(outline, aspect) {
    this.outline = outline;
    this.reset(aspect);
  }
  reset(aspect) {
    this.turn = 0.49;
    this.rise = 0.38;
    this.target = [0, 0, 0];
    let near = 1.1, far = 12;
    for (let i = 0; i < 30; ++i) {
      this.distance = 0.5 * (near + far);
      if (this.sees(aspect)) far = this.distance;
      else near = this.distance;
    }
  }
  sees(aspect) {
    const m = this.matrix(aspect);
    return this.outline.every((p) => {
      const [x, y, , w] = [0, 1, 2, 3].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
      return Math.max(Math.abs(x), Math.abs(y)) < 0.93 * w;
    });
  }
  /** Right, up, towards the eye. */
  axes() {
    const [r, u, f] = this.base;
    const flat = added(scaled(Math.cos(this.turn), f), scaled(Math.sin(this.turn), r));
    const eye = added(scaled(Math.cos(this.rise), flat), scaled(Math.sin(this.rise), u));
    const x = added(scaled(Math.cos(this.turn), r), scaled(-Math.sin(this.turn), f));
    return [x, crossed(eye, x), eye];
  }
  rotate(dx, dy) {
    this.turn -= dx;
    this.rise = Math.max(-1.5, Math.min(1.5, this.rise + dy));
  }
  zoom(factor) { this.distance = Math.max(0.02, Math.min(40, this.distance * factor)); }
  shift(dx, dy) {
    const [x, y] = this.axes();
    this.target = added(this.target, added(scaled(-dx * this.distance, x), scaled(dy * this.distance, y)));
  }
  /** Column by column. */
  matrix(aspect) {
    const [x, y, z] = this.axes();
    const eye = added(this.target, scaled(this.distance, z));
    const near = 0.02 * this.distance, far = this.distance + 4;
    const f = 2.6, w = aspect > 1 ? f / aspect : f, h = aspect > 1 ? f : f * aspect;
    const a = (far + near) / (near - far), b = (2 * far * near) / (near - far);
    const rows = [[w, x], [h, y]].map(([s, v]) => [...scaled(s, v), -s * inner(v, eye)]);
    const depth = [...scaled(a, z), -a * inner(z, eye) + b], back = [...scaled(-1, z), inner(z, eye)];
    const all = [rows[0], rows[1], depth, back];
    return new Float32Array([0, 1, 2, 3].flatMap((column) => all.map((row) => row[column])));
  }
}

/** Triangles on the device, and the cell or the triangle of the skin that each came from. */
class TriangleList {
  constructor(gl) {
    this.gl = gl;
    this.buffer = gl.createBuffer();
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.UNSIGNED_SHORT, false, 8, 0);
    this.count = 0;
    this.origin = new Int32Array(0);
  }
  /** `fill(put)` calls put(a, b, c, code, origin) for each of at most `most` triangles. */
  set(points, most, fill) {
    const data = new Uint16Array(12 * most), origin = new Int32Array(most);
    let n = 0;
    const corner = (at, v, code) => {
      data[at] = points[3 * v];
      data[at + 1] = points[3 * v + 1];
      data[at + 2] = points[3 * v + 2];
      data[at + 3] = code;
    };
    fill((a, b, c, code, from) => {
      corner(12 * n, a, code);
      corner(12 * n + 4, b, code);
      corner(12 * n + 8, c, code);
      origin[n++] = from;
    });
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data.subarray(0, 12 * n), gl.DYNAMIC_DRAW);
    this.count = n;
    this.origin = origin.subarray(0, n);
  }
  draw() {
    if (this.count === 0) return;
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, 3 * this.count);
  }
}

class MeshView {
  /** `low`, `high`: box of the packed coordinates; `frame`: {centre, radius} of both meshes. */
  constructor(canvas, mesh, packed, frame) {
    this.canvas = canvas;
    this.mesh = mesh;
    this.frame = frame;
    this.low = packed.low;
    this.step = subtract(packed.high, packed.low).map((e) => e / 65535);
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("WebGL 2 is missing");
    this.gl = gl;
    this.program = this.link();
    this.places = new Proxy({}, { get: (known, name) => known[name] ?? (known[name] = gl.getUniformLocation(this.program, name)) });
    for (const name of ["skin", "faces", "poor", "invalid", "picked"]) this[name] = new TriangleList(gl);
    this.invalid.set(mesh.points, this.cellsBelow(1) * 4, (put) => this.putCells(0, 1, put));
  }
  link() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "corner");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }
  /** Cells with a code below this. */
  cellsBelow(code) {
    let n = 0;
    for (const mine of this.mesh.codes) n += mine < code ? 1 : 0;
    return n;
  }
  /** All faces of the cells with codes from `first` to below `end`. */
  putCells(first, end, put) {
    const { cells, codes } = this.mesh;
    for (let i = 0; i < codes.length; ++i)
      if (codes[i] >= first && codes[i] < end)
        for (const [p, q, r] of FACES) put(cells[4 * i + p], cells[4 * i + q], cells[4 * i + r], codes[i], i);
  }
  setLimit(degrees) {
    const end = 1 + Math.ceil(STEPS_PER_DEGREE * degrees);
    this.poor.set(this.mesh.points, this.cellsBelow(end) * 4, (put) => this.putCells(1, end, put));
  }
  /** axis 0, 1, 2, or -1 for no cut; `beyond` +1: what has larger coordinates than `at` goes. */
  setCut(axis, at, beyond) {
    const { mesh } = this;
    const { points, cells, codes, skin, skinCell } = mesh;
    const gone = new Uint8Array(mesh.nVertices);
    if (axis >= 0) {
      const place = (at - this.low[axis]) / (this.step[axis] || 1);
      for (let v = 0; v < mesh.nVertices; ++v) gone[v] = (points[3 * v + axis] - place) * beyond > 0 ? 1 : 0;
    }
    this.skin.set(points, skin.length / 3, (put) => {
      for (let t = 0; t < skin.length / 3; ++t) {
        const a = skin[3 * t], b = skin[3 * t + 1], c = skin[3 * t + 2];
        if (gone[a] + gone[b] + gone[c] < 3) put(a, b, c, skinCell[t] < 0 ? GOOD : codes[skinCell[t]], t);
      }
    });
    // Only cells with one vertex on the near side have a face with none there, and that one is seen.
    const open = [];
    if (axis >= 0)
      for (let i = 0, k = 0; i < mesh.nCells; ++i, k += 4)
        if (gone[cells[k]] + gone[cells[k + 1]] + gone[cells[k + 2]] + gone[cells[k + 3]] === 3) open.push(i);
    this.faces.set(points, open.length, (put) => {
      for (const i of open) {
        const v = [0, 1, 2, 3].map((k) => cells[4 * i + k]).filter((v) => gone[v]);
        put(v[0], v[1], v[2], codes[i], i);
      }
    });
  }
  /** The vertices of the surface that are farthest out, one for each of 64 directions; lengths are those of Camera. */
  outline() {
    const { skin, points, nVertices } = this.mesh;
    const isOutside = new Uint8Array(nVertices);
    for (const v of skin) isOutside[v] = 1;
    const found = [];
    for (let i = 0, n = 64; i < n; ++i) {
      const z = (2 * i + 1) / n - 1, turn = 2.399963 * i, r = Math.sqrt(1 - z * z);
      const [x1, y1, z1] = [r * Math.cos(turn), r * Math.sin(turn), z].map((d, axis) => d * this.step[axis]);
      let best = -1, most = -Infinity;
      for (let v = 0, k = 0; v < nVertices; ++v, k += 3) {
        if (!isOutside[v]) continue;
        const far = x1 * points[k] + y1 * points[k + 1] + z1 * points[k + 2];
        if (far > most) {
          most = far;
          best = k;
        }
      }
      if (best >= 0) found.push([0, 1, 2].map((axis) =>
        (this.low[axis] + this.step[axis] * points[best + axis] - this.frame.centre[axis]) / this.frame.radius));
    }
    return found;
  }
  setPicked(cell) {
    const { cells, points } = this.mesh;
    this.picked.set(points, 4, (put) => {
      if (cell >= 0) for (const [p, q, r] of FACES) put(cells[4 * cell + p], cells[4 * cell + q], cells[4 * cell + r], GOOD, cell);
    });
  }
  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
  }
  begin(camera, limit) {
    const { gl, places, frame } = this;
    const [right, up, eye] = camera.axes();
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.useProgram(this.program);
    gl.uniformMatrix4fv(places.matrix, false, camera.matrix(this.canvas.width / this.canvas.height));
    gl.uniform3fv(places.low, scaled(1 / frame.radius, subtract(this.low, frame.centre)));
    gl.uniform3fv(places.unit, scaled(1 / frame.radius, this.step));
    gl.uniform3fv(places.towardsEye, eye);
    gl.uniform3fv(places.up, up);
    gl.uniform3fv(places.right, right);
    gl.uniform1f(places.limit, limit);
    gl.uniform1i(places.first, -1);
    gl.uniform1f(places.opacity, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
  /** state: {limit, opacity, floating}; colours: {paper, surface, inside, edge}. */
  draw(camera, state, colours) {
    const { gl, places } = this;
    this.resize();
    this.begin(camera, state.limit);
    gl.clearColor(...colours.paper, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const put = (list, others, opacity, edgeOpacity, edge = colours.edge) => {
      gl.uniform3fv(places.others, others);
      gl.uniform3fv(places.edge, edge);
      gl.uniform1f(places.opacity, opacity);
      gl.uniform1f(places.edgeOpacity, edgeOpacity);
      list.draw();
    };
    const blend = (on) => {
      (on ? gl.enable : gl.disable).call(gl, gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(!on);
    };
    const solid = state.opacity >= 1;
    if (!solid || state.floating) put(this.poor, colours.inside, 1, 0.7);
    if (solid || state.opacity > 0) {
      if (!solid) blend(true);
      put(this.skin, colours.surface, state.opacity, 0.6);
      put(this.faces, colours.inside, state.opacity, 0.6);
      blend(false);
    }
    if (this.invalid.count > 0) {
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.BLEND);
      put(this.invalid, colours.inside, 0.85, 0.9, [1, 1, 1]);
    }
    if (this.picked.count > 0) {
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.BLEND);
      put(this.picked, [0, 0.78, 0.66], 0.8, 1, [0, 0.1, 0.1]);
    }
    gl.disable(gl.BLEND);
  }
  /** The cell at a place of the canvas in CSS pixels; -1 where there is none. */
  pick(x, y, camera, state) {
    const { gl, places, canvas } = this;
    const { width, height } = canvas;
    const target = gl.createFramebuffer(), colour = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    for (const [buffer, format, place] of [[colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
    this.begin(camera, state.limit);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const shown = [];
    let first = 0;
    const put = (list, isSkin) => {
      gl.uniform1i(places.first, first);
      list.draw();
      shown.push({ list, isSkin, first });
      first += list.count;
    };
    const solid = state.opacity >= 1;
    if (!solid || state.floating) put(this.poor, false);
    if (solid || this.poor.count === 0) {
      put(this.skin, true);
      put(this.faces, false);
    }
    if (this.invalid.count > 0) {
      gl.clear(gl.DEPTH_BUFFER_BIT);
      put(this.invalid, false);
    }
    const pixel = new Uint8Array(4);
    const column = Math.floor((x * width) / canvas.clientWidth), row = Math.floor(height - 1 - (y * height) / canvas.clientHeight);
    gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target);
    gl.deleteRenderbuffer(colour);
    gl.deleteRenderbuffer(depth);
    const id = pixel[0] + 256 * (pixel[1] + 256 * (pixel[2] + 256 * pixel[3])) - 1;
    if (id < 0) return -1;
    const hit = shown.filter((s) => s.first <= id && id < s.first + s.list.count)[0];
    const origin = hit.list.origin[id - hit.first];
    return hit.isSkin ? cellOfSkin(this.mesh, origin) : origin;
  }
  /** The cell whose middle is nearest to a point of the mesh's own coordinates. */
  cellAt(middle) {
    const { cells, points } = this.mesh;
    let best = -1, least = Infinity;
    for (let i = 0; i < this.mesh.nCells; ++i) {
      let distance = 0;
      for (let axis = 0; axis < 3; ++axis) {
        let sum = 0;
        for (let k = 0; k < 4; ++k) sum += points[3 * cells[4 * i + k] + axis];
        distance += (this.low[axis] + (this.step[axis] * sum) / 4 - middle[axis]) ** 2;
      }
      if (distance < least) {
        least = distance;
        best = i;
      }
    }
    return best;
  }
  /** In the mesh's own coordinates, rounded to 16 bits. */
  cornersOf(cell) {
    return [0, 1, 2, 3].map((k) => {
      const v = this.mesh.cells[4 * cell + k];
      return [0, 1, 2].map((i) => this.low[i] + this.step[i] * this.mesh.points[3 * v + i]);
    });
  }
}
