// Probe, fan, phantom and the frame that has come, in space. WebGL 2; drawn when something changes, and while it is open.

const spaceVertex = `#version 300 es
uniform mat4 toScreen;
layout(location = 0) in vec3 position;
out vec3 place;
void main() { place = position; gl_Position = toScreen * vec4(position, 1.0); }`;
const spaceFragment = `#version 300 es
precision highp float;
uniform vec4 colour;
uniform vec3 eye;
uniform bool lit;
in vec3 place;
out vec4 shown;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = lit ? 0.25 + 0.75 * abs(dot(normal, normalize(eye - place))) : 1.0;
  shown = vec4(colour.rgb * light, colour.a);
}`;

/** Column-major 4 x 4 matrices, as WebGL takes them. */
function product(a, b) {
  return Float32Array.from({length: 16}, (_, index) => {
    const [column, row] = [Math.floor(index / 4), index % 4];
    return [0, 1, 2, 3].reduce((sum, each) => sum + a[4 * each + row] * b[4 * column + each], 0);
  });
}

function perspective(aspect, near, far) {
  const focus = 2.2;
  return new Float32Array([focus / aspect, 0, 0, 0, 0, focus, 0, 0,
    0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]);
}

/** Rows right, up and back of a viewer at `eye`. */
function viewFrom(eye, right, up, back) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
}

class Space {
  /** `wants(isOpen)` says whether the program's messages are needed. */
  constructor(wants) {
    Object.assign(this, {turn: [-0.65, 0.4], distance: 330, middle: [0, 0, 90], parts: {}, frames: 0});
    this.canvas = make('canvas', {width: 640, height: 400, tabindex: '0', role: 'application',
      'aria-label': 'Probe, fan and phantom in space. Arrow keys turn, plus and minus move nearer and away.'});
    this.text = make('p', {class: 'reading'});
    this.element = make('details', {class: 'space', ontoggle: () => { wants(this.element.open); this.draw(); }},
      make('summary', {}, 'Probe and phantom in space'), this.canvas, this.text);
    this.listen();
  }

  listen() {
    const {canvas} = this;
    canvas.addEventListener('pointerdown', (event) => { canvas.setPointerCapture(event.pointerId); this.drag = event; });
    canvas.addEventListener('pointermove', (event) => {
      if (!this.drag) return;
      this.rotate((event.clientX - this.drag.clientX) / 150, (event.clientY - this.drag.clientY) / 150);
      this.drag = event;
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { this.drag = null; });
    canvas.addEventListener('wheel', (event) => { event.preventDefault(); this.approach(Math.exp(event.deltaY / 600)); }, {passive: false});
    canvas.addEventListener('keydown', (event) => {
      const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
      const moves = {'+': 0.85, '-': 1.18};
      if (turns[event.key]) this.rotate(...turns[event.key]);
      else if (moves[event.key]) this.approach(moves[event.key]);
      else return;
      event.preventDefault();
    });
  }

  rotate(right, down) {
    this.turn = [this.turn[0] + right, within(this.turn[1] + down, -1.5, 1.5)];
    this.draw();
  }

  approach(factor) {
    this.distance = within(this.distance * factor, 60, 1500);
    this.draw();
  }

  /** Once for each stream. */
  take(header, [sticks, ...meshes]) {
    this.header = header;
    this.sticks = new Float32Array(sticks);
    const [frames, lines] = [header.frames.length, header.lines.length];
    const at = (frame, line, end) => this.sticks.subarray(6 * (frame * lines + line) + 3 * end, 6 * (frame * lines + line) + 3 * end + 3);
    const fan = [];
    const join = (a, b) => fan.push(...a, ...b);
    for (const frame of [0, frames - 1]) {
      for (let line = 1; line < lines; ++line) for (const end of [0, 1]) join(at(frame, line - 1, end), at(frame, line, end));
      for (const line of [0, lines - 1]) join(at(frame, line, 0), at(frame, line, 1));
    }
    const face = [];
    for (let frame = 1; frame < frames; ++frame) {
      for (const line of [0, lines - 1]) join(at(frame - 1, line, 1), at(frame, line, 1));
      for (let line = 1; line < lines; ++line) {
        const corners = [at(frame - 1, line - 1, 0), at(frame, line - 1, 0), at(frame, line, 0), at(frame - 1, line, 0)];
        face.push(...corners[0], ...corners[1], ...corners[2], ...corners[0], ...corners[2], ...corners[3]);
      }
    }
    for (const name of Object.keys(this.parts)) if (name !== 'box') this.drop(name);
    this.set('fan', {places: fan, kind: 'lines', colour: [0.45, 0.55, 0.65, 1]});
    this.set('face', {places: face, kind: 'triangles', colour: [0.35, 0.5, 0.75, 1]});
    header.surfaces.forEach((name, index) => this.set(`surface ${name}`, {places: new Float32Array(meshes[2 * index]),
      corners: new Uint32Array(meshes[2 * index + 1]), kind: 'triangles', colour: [0.85, 0.66, 0.52, 1]}));
    this.text.textContent = `Blue: the probe's face; outlined: the fan; box: the volume of interest; yellow: the frame that has come, red: its lost sticks`
      + `${header.surfaces.length ? `; ${header.surfaces.map((name) => name.replaceAll('_', ' ')).join(', ')}${header.moves ? ' as at the beginning: its motion is not drawn' : ''}` : ''}.`;
  }

  /** A frame has come. */
  takeFrame({frame, lost, volume}) {
    if (!this.header) return;
    const {frames, lines} = this.header;
    const drawn = frames.reduce((best, each, index) => Math.abs(each - frame) < Math.abs(frames[best] - frame) ? index : best, 0);
    const isLost = new Set(lost);
    const sticks = {came: [], lost: []};
    lines.forEach((line, index) => {
      const from = 6 * (drawn * lines.length + index);
      sticks[isLost.has(line) ? 'lost' : 'came'].push(...this.sticks.subarray(from, from + 6));
    });
    this.set('came', {places: sticks.came, kind: 'lines', colour: [0.95, 0.75, 0.2, 1]});
    this.set('lost', {places: sticks.lost, kind: 'lines', colour: [0.9, 0.15, 0.1, 1]});
    Object.assign(this.element.dataset, {frame, volume});
  }

  /** The volume of interest, mm. */
  setBox({center_mm, size_mm}) {
    const key = JSON.stringify([center_mm, size_mm]);
    if (this.boxKey === key) return;
    this.boxKey = key;
    const corner = (bits) => center_mm.map((middle, axis) => middle + (bits >> axis & 1 ? 0.5 : -0.5) * size_mm[axis]);
    const places = [];
    for (let bits = 0; bits < 8; ++bits) {
      for (let axis = 0; axis < 3; ++axis) if (!(bits >> axis & 1)) places.push(...corner(bits), ...corner(bits | 1 << axis));
    }
    this.middle = center_mm;
    this.set('box', {places, kind: 'lines', colour: [0.3, 0.75, 0.45, 1]});
  }

  start() {
    const gl = this.canvas.getContext('webgl2', {antialias: true});
    if (!gl) {
      this.text.textContent = 'This browser has no WebGL 2: nothing is drawn here.';
      return null;
    }
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, spaceVertex], [gl.FRAGMENT_SHADER, spaceFragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    gl.enableVertexAttribArray(0);
    const uniform = (name) => gl.getUniformLocation(program, name);
    this.uniforms = {toScreen: uniform('toScreen'), colour: uniform('colour'), eye: uniform('eye'), lit: uniform('lit')};
    return gl;
  }

  /** A part with its buffers, which it keeps from one time to the next. */
  set(name, part) {
    this.parts[name] = {...this.parts[name], ...part, isNew: true};
    this.draw();
  }

  drop(name) {
    const {buffer, index} = this.parts[name];
    for (const each of [buffer, index]) if (each) this.gl.deleteBuffer(each);
    delete this.parts[name];
  }

  /** With the next picture of the screen. */
  draw() {
    if (!this.element.open || this.asked) return;
    this.asked = requestAnimationFrame(() => { this.asked = 0; this.drawNow(); });
  }

  drawNow() {
    this.gl ??= this.start();
    const {gl, uniforms} = this;
    if (!gl || gl.isContextLost()) return;
    const [yaw, pitch] = this.turn;
    const back = [Math.sin(yaw) * Math.cos(pitch), -Math.sin(pitch), -Math.cos(yaw) * Math.cos(pitch)];
    const right = [Math.cos(yaw), 0, Math.sin(yaw)];
    // As in the picture y points down.
    const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]];
    const eye = this.middle.map((middle, axis) => middle + this.distance * back[axis]);
    const {width, height} = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.07, 0.08, 0.1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(uniforms.toScreen, false, product(perspective(width / height, 10, 3000), viewFrom(eye, right, up, back)));
    gl.uniform3fv(uniforms.eye, eye);
    for (const part of Object.values(this.parts)) this.drawPart(part);
    this.element.dataset.drawn = ++this.frames;
  }

  drawPart(part) {
    const {gl, uniforms} = this;
    part.buffer ??= gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, part.buffer);
    if (part.corners) {
      part.index ??= gl.createBuffer();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, part.index);
    }
    if (part.isNew) {
      part.isNew = false;
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(part.places), gl.DYNAMIC_DRAW);
      if (part.corners) gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, part.corners, gl.STATIC_DRAW);
    }
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.uniform4fv(uniforms.colour, part.colour);
    gl.uniform1i(uniforms.lit, part.kind === 'triangles');
    const mode = part.kind === 'lines' ? gl.LINES : gl.TRIANGLES;
    if (part.corners) gl.drawElements(mode, part.corners.length, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(mode, 0, part.places.length / 3);
  }
}
