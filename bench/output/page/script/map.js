// Maps: a value a pixel, under the pointer or chosen by the arrow keys, with a colour bar and classes of pixels.

const noValue = 65535;

/** Bytes of the base64 text of zlib's format. */
async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Little-endian numbers of 16 bits. */
function uint16(bytes) {
  const view = new DataView(bytes.buffer);
  return Uint16Array.from({length: bytes.length / 2}, (_, index) => view.getUint16(2 * index, true));
}

class ValueMap {
  constructor(figure) {
    this.figure = figure;
    this.data = dataOf(figure);
    this.layer = 0;
    this.hiddenClasses = new Set();
    this.pixel = {column: Math.floor(this.data.width / 2), row: Math.floor(this.data.height / 2)};
    this.build();
  }

  async load() {
    this.codes = await Promise.all(this.data.layers.map(async ({codes}) => uint16(await inflate(codes))));
    this.classes = this.data.class_codes ? await inflate(this.data.class_codes) : null;
    this.draw();
    this.figure.toggleAttribute('data-ready', true);
  }

  build() {
    const {width, height, layers} = this.data;
    const caption = this.figure.querySelector('figcaption')?.textContent ?? 'Map';
    this.canvas = make('canvas', {width, height, tabindex: '0', role: 'application',
      'aria-label': `${caption} Arrow keys move from pixel to pixel.`});
    this.cross = make('div', {class: 'cross', hidden: true});
    this.reading = make('p', {class: 'reading', 'aria-live': 'polite'}, 'Point at the map to read its values.');
    this.bar = make('div', {class: 'colour-bar'});
    this.canvas.classList.toggle('coarse', width < 200);
    const stage = make('div', {class: 'stage'}, this.canvas, this.cross, ...this.scaleBar());
    const layerChoice = layers.length > 1
      ? [choice('Layer', layers.map(({name}) => name), (index) => { this.layer = index; this.draw(); })] : [];
    const tools = make('div', {class: 'tools'}, ...layerChoice, ...this.classBoxes());
    this.figure.prepend(tools, stage, this.bar, this.reading);
    this.listen();
  }

  /** 10 mm in the picture. */
  scaleBar() {
    const share = 10 / this.data.mm_per_pixel / this.data.width;
    if (!(share > 0 && share < 1)) return [];
    const bar = make('div', {class: 'scale-bar'}, '10 mm');
    bar.style.width = `${100 * share}%`;
    return [bar];
  }

  classBoxes() {
    return (this.data.classes ?? []).map(({code, name, colour}) => {
      const box = make('input', {type: 'checkbox', checked: true, onchange: () => {
        this.hiddenClasses[box.checked ? 'delete' : 'add'](code);
        this.draw();
      }});
      const swatch = make('span', {class: 'swatch'});
      swatch.style.background = colour;
      return make('label', {class: 'class'}, box, swatch, name);
    });
  }

  listen() {
    const point = (event) => this.point(event);
    this.canvas.addEventListener('pointermove', point);
    this.canvas.addEventListener('pointerdown', point);
    this.canvas.addEventListener('focus', () => { this.cross.hidden = false; this.read(); });
    this.canvas.addEventListener('blur', () => { this.cross.hidden = true; });
    this.canvas.addEventListener('keydown', (event) => this.moveByKey(event));
  }

  point(event) {
    const box = this.canvas.getBoundingClientRect();
    this.moveTo(Math.floor((event.clientX - box.left) / box.width * this.data.width),
      Math.floor((event.clientY - box.top) / box.height * this.data.height));
  }

  moveByKey(event) {
    const step = event.shiftKey ? 10 : 1;
    const moves = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step]};
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    this.moveTo(this.pixel.column + move[0], this.pixel.row + move[1]);
  }

  moveTo(column, row) {
    const within = (value, size) => Math.min(size - 1, Math.max(0, value));
    this.pixel = {column: within(column, this.data.width), row: within(row, this.data.height)};
    this.read();
  }

  valueAt(layer, index) {
    const code = this.codes[layer][index];
    const {first, step} = this.data.layers[layer];
    return code === noValue ? null : first + step * code;
  }

  classAt(index) {
    return this.classes && (this.data.classes ?? []).find(({code}) => code === this.classes[index]);
  }

  /** Says what the chosen pixel holds, for people and for programs. */
  read() {
    if (!this.codes) return;
    const {column, row} = this.pixel;
    const {width, height, layers} = this.data;
    const index = row * width + column;
    const values = layers.map((_, layer) => this.valueAt(layer, index));
    const parts = layers.map(({name, unit, low, high}, layer) => values[layer] === null
      ? `${name} none` : `${name} ${values[layer].toFixed(digitsFor(low, high))} ${unit}`);
    const kind = this.classAt(index);
    this.reading.textContent = `column ${column}, row ${row}: ${parts.join(', ')}${kind ? `; ${kind.name}` : ''}`;
    Object.assign(this.reading.dataset, {column, row, values: JSON.stringify(values)});
    this.cross.style.left = `${100 * (column + 0.5) / width}%`;
    this.cross.style.top = `${100 * (row + 0.5) / height}%`;
  }

  draw() {
    const {width, height, layers} = this.data;
    const {low, high, colours} = layers[this.layer];
    const table = colourTable(colours);
    const image = new ImageData(width, height);
    const classColours = this.classColours();
    for (let index = 0; index < width * height; ++index) {
      const value = this.valueAt(this.layer, index);
      const share = Math.min(1, Math.max(0, (value - low) / (high - low)));
      const colour = classColours.get(this.classes?.[index]) ?? (value === null ? null : table[Math.round(255 * share)]);
      if (colour) image.data.set([...colour, 255], 4 * index);
    }
    this.canvas.getContext('2d').putImageData(image, 0, 0);
    this.drawColourBar(table);
  }

  classColours() {
    const shown = (this.data.classes ?? []).filter(({code}) => !this.hiddenClasses.has(code));
    return new Map(shown.map(({code, colour}) => [code, rgb(colour)]));
  }

  drawColourBar(table) {
    const {name, unit, low, high} = this.data.layers[this.layer];
    const strip = make('canvas', {width: table.length, height: 1, 'aria-hidden': 'true'});
    strip.getContext('2d').putImageData(
      new ImageData(Uint8ClampedArray.from(table.flatMap((colour) => [...colour, 255])), table.length, 1), 0, 0);
    const ticks = roundTicks(low, high);
    const digits = Math.max(0, ...ticks.map((tick) => (String(+tick.toPrecision(6)).split('.')[1] ?? '').length));
    const labels = ticks.map((tick) => {
      const label = make('span', {}, tick.toFixed(digits).replace('-', '−'));
      label.style.left = `${100 * (tick - low) / (high - low)}%`;
      return label;
    });
    this.bar.replaceChildren(strip, make('div', {class: 'ticks'}, ...labels), make('div', {class: 'title'}, `${name}, ${unit}`));
  }
}
