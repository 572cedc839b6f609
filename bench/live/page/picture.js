// The picture: found surface, error or truth, turned and lit by dragging, magnified by the wheel.

const modes = ['Picture', 'Error', 'Truth'];
const most = {zoom: 8};

function within(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/** Depths of a map as numbers in mm; null: none. */
function depthsOf({low_mm, step_mm}, part) {
  const codes = new Uint16Array(part);
  return (index) => codes[index] === noDepth ? null : low_mm + step_mm * codes[index];
}
const noDepth = 65535;

class Picture {
  /** `send(key, value)` sets a number; `wants(maps)` says whether depths are needed. */
  constructor(send, wants, hasTruth) {
    Object.assign(this, {send, wants, mode: 'Picture', drags: 'view', zoom: 1, at: [0.5, 0.5], values: {}});
    this.canvas = make('canvas', {width: 512, height: 512, tabindex: '0', role: 'application',
      'aria-label': 'Picture. Arrow keys turn the head, with Shift they move the light, plus and minus magnify.'});
    this.stage = make('div', {class: 'stage'}, this.canvas);
    this.reading = make('p', {class: 'reading'}, hasTruth ? 'Choose Error or Truth to read depths under the pointer.' : '');
    this.legend = make('div', {class: 'legend', hidden: true});
    const drags = choice('Dragging', ['Drag turns', 'Drag moves the light'], (index) => { this.drags = ['view', 'light'][index]; });
    const shown = choice('Shown', hasTruth ? modes : ['Picture', 'Depth'], (index) => this.show(hasTruth ? modes[index] : ['Picture', 'Depth'][index]));
    this.element = make('div', {class: 'picture'}, make('div', {class: 'tools'}, shown, drags), this.stage, this.legend, this.reading);
    this.listen();
  }

  listen() {
    const {canvas} = this;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.drag = {x: event.clientX, y: event.clientY, start: this.angles(event.shiftKey)};
    });
    canvas.addEventListener('pointermove', (event) => { this.drag ? this.dragTo(event) : this.read(event); });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { this.drag = null; });
    canvas.addEventListener('wheel', (event) => { event.preventDefault(); this.magnify(event); }, {passive: false});
    canvas.addEventListener('dblclick', () => this.setZoom(1));
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  /** What dragging turns: the keys of its two angles, and their values now. */
  angles(isLight) {
    const light = isLight || this.drags === 'light';
    const {view = {}, shading = {}} = this.values.render ?? {};
    // The surface follows the pointer: dragged to the right the eye moves to the left.
    return light
      ? {keys: ['render.shading.light_left_deg', 'render.shading.light_up_deg'], limit: 89,
        values: [shading.light_left_deg, shading.light_up_deg], signs: [-1, -1]}
      : {keys: ['render.view.yaw_deg', 'render.view.pitch_deg'], limit: 180,
        values: [view.yaw_deg, view.pitch_deg], signs: [view.flip ? 1 : -1, 1]};
  }

  turn({keys, values, signs, limit}, right, down) {
    [right, down].forEach((degrees, axis) => {
      if (degrees === 0) return;
      let angle = values[axis] + signs[axis] * degrees;
      angle = limit === 180 ? (angle + 540) % 360 - 180 : within(angle, -limit, limit);
      this.send(keys[axis], Number(angle.toFixed(1)));
    });
  }

  dragTo(event) {
    const side = this.canvas.clientWidth;
    const degrees = (pixels) => pixels / side * 180;
    this.turn(this.drag.start, degrees(event.clientX - this.drag.x), degrees(event.clientY - this.drag.y));
  }

  key(event) {
    const moves = {ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5]};
    const zooms = {'+': 1.25, '-': 0.8};
    if (moves[event.key]) this.turn(this.angles(event.shiftKey), ...moves[event.key]);
    else if (zooms[event.key]) this.setZoom(this.zoom * zooms[event.key]);
    else return;
    event.preventDefault();
  }

  magnify(event) {
    const box = this.stage.getBoundingClientRect();
    this.at = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    this.setZoom(this.zoom * Math.exp(-event.deltaY / 400));
  }

  setZoom(zoom) {
    this.zoom = within(zoom, 1, most.zoom);
    this.canvas.style.transformOrigin = `${100 * this.at[0]}% ${100 * this.at[1]}%`;
    this.canvas.style.transform = `scale(${this.zoom})`;
  }

  show(mode) {
    this.mode = mode;
    this.wants(mode !== 'Picture');
    this.draw();
  }

  /** Another view takes the picture's place. */
  cover(isCovered) {
    this.stage.hidden = isCovered;
    this.element.classList.toggle('covered', isCovered);
  }

  /** An earlier volume is shown; what is here is of another. */
  setPast(isPast) {
    this.isPast = isPast;
    this.draw();
  }

  isStale() {
    if (this.mode === 'Picture' || !this.picture) return false;
    const [maps, picture] = [this.maps.header, this.picture.header];
    return maps.serial !== picture.serial || Boolean(this.isPast) && maps.volume !== picture.volume;
  }

  // What is here stays whole until the next is decoded: it may be drawn again meanwhile.
  async takePicture(header, [part]) {
    const image = await createImageBitmap(new Blob([part], {type: 'image/jpeg'}));
    this.picture?.image.close();
    this.picture = {header, image};
    this.draw();
  }

  async takeMaps(header, [found, truth, classes, shaded]) {
    const maps = {header, found: depthsOf(header, found)};
    if (truth) {
      const hasShaded = shaded.byteLength > 0;
      Object.assign(maps, {truth: depthsOf(header, truth), classes: new Uint8Array(classes),
        shaded: hasShaded ? await createImageBitmap(new Blob([shaded], {type: 'image/jpeg'})) : null});
    }
    this.maps = maps;
    this.draw();
  }

  draw() {
    const ready = this.mode === 'Picture' ? this.picture : this.maps;
    if (!ready) return;
    const {width, height} = ready.header;
    if (this.canvas.width !== width) Object.assign(this.canvas, {width, height});
    const context = this.canvas.getContext('2d');
    if (this.mode === 'Picture') context.drawImage(this.picture.image, 0, 0);
    else if (this.mode === 'Truth' && this.maps.shaded) context.drawImage(this.maps.shaded, 0, 0);
    else context.putImageData(this.mapImage(), 0, 0);
    this.stage.classList.toggle('stale', this.isStale());
    this.stage.classList.toggle('coarse', Boolean(ready.header.coarse));
    this.element.dataset.drawn = this.mode;
    // Of a coarse picture the one of all pixels is still to come.
    if (!ready.header.coarse) Object.assign(this.canvas.dataset, {serial: ready.header.serial, volume: ready.header.volume});
    this.drawLegend();
  }

  errorAt(index) {
    const [found, truth] = [this.maps.found(index), this.maps.truth?.(index) ?? null];
    return found === null || truth === null ? null : found - truth;
  }

  mapImage() {
    const {header, classes} = this.maps;
    const isError = this.mode === 'Error';
    const limit = header.limit_mm;
    const [low, high] = isError ? [-limit, limit] : this.depthRange();
    const table = colourTable(isError ? 'diverging' : 'sequential');
    const kinds = new Map((header.classes ?? []).map(({code, colour}) => [code, rgb(colour)]));
    const image = new ImageData(header.width, header.height);
    for (let index = 0; index < header.width * header.height; ++index) {
      const value = isError ? this.errorAt(index) : this.maps.found(index);
      const shade = value === null ? [43, 43, 43] : table[Math.round(255 * within((value - low) / (high - low), 0, 1))];
      image.data.set([...(isError && kinds.get(classes[index]) || shade), 255], 4 * index);
    }
    return image;
  }

  depthRange() {
    const {header, found} = this.maps;
    let low = Infinity, high = -Infinity;
    for (let index = 0; index < header.width * header.height; ++index) {
      const depth = found(index);
      if (depth === null) continue;
      low = Math.min(low, depth);
      high = Math.max(high, depth);
    }
    return low < high ? [low, high] : [0, 1];
  }

  drawLegend() {
    const header = this.maps?.header;
    this.legend.hidden = this.mode !== 'Error' || !header?.classes;
    if (this.legend.hidden) return;
    const key = JSON.stringify(header.classes);
    const [p95, bias] = [header.p95_mm, header.bias_mm];
    const figures = p95 === null ? 'no surface is found where one is to be seen'
      : `P95 ${p95.toFixed(2)} mm, bias ${bias.toFixed(2)} mm, missed ${header.missed_percent.toFixed(1)} %, false ${header.false_percent.toFixed(1)} %`;
    if (this.legendKey !== key) {
      const swatch = (colour, name) => {
        const square = make('span', {class: 'swatch'});
        square.style.background = colour;
        return make('span', {class: 'class'}, square, name);
      };
      this.figures = make('p', {class: 'figures'});
      const ends = make('span', {class: 'ends'}, `found − true: −${header.limit_mm} mm `, make('span', {class: 'ramp'}), ` +${header.limit_mm} mm`);
      this.legend.replaceChildren(ends, ...header.classes.map(({colour, name}) => swatch(colour, name)), this.figures);
      this.legendKey = key;
    }
    this.figures.textContent = figures;
  }

  /** Depth, true depth and error of the pixel under the pointer. */
  read(event) {
    if (!this.maps || this.mode === 'Picture') return;
    const box = this.canvas.getBoundingClientRect();
    const {width, height} = this.maps.header;
    const column = within(Math.floor((event.clientX - box.left) / box.width * width), 0, width - 1);
    const row = within(Math.floor((event.clientY - box.top) / box.height * height), 0, height - 1);
    const index = row * width + column;
    const mm = (value) => value === null ? 'none' : `${value.toFixed(2).replace('-', '−')} mm`;
    const parts = [`column ${column}, row ${row}: found ${mm(this.maps.found(index))}`];
    if (this.maps.truth) {
      const kind = this.maps.header.classes.find(({code}) => code === this.maps.classes[index]);
      parts.push(`true ${mm(this.maps.truth(index))}`, kind ? kind.name : `error ${mm(this.errorAt(index))}`);
    }
    this.reading.textContent = parts.join(', ');
  }
}
