// Controls of the settings, as the program describes them.

const units = {mm: 'mm', deg: '°', db: 'dB', ms: 'ms', s: 's', weeks: 'weeks', mhz: 'MHz', hz: 'Hz', percent: '%', bytes: 'bytes'};

/** "light_left_deg" as its name and unit. */
function nameAndUnit(key) {
  const words = key.split('_');
  const unit = words.length > 1 ? units[words.at(-1)] : undefined;
  if (unit) words.pop();
  const isRate = unit && words.at(-1) === 'per';
  if (isRate) words.pop();
  const name = words.join(' ');
  return {name: name[0].toUpperCase() + name.slice(1), unit: `${isRate ? '/' : ''}${unit ?? ''}`};
}

function sectionName(section) {
  const name = section === 'render' ? 'preset' : section.replace(/^render\./, '');
  return name[0].toUpperCase() + name.slice(1).replaceAll('_', ' ');
}

/** A value of the program as TOML writes it. */
function asToml(value) {
  return Array.isArray(value) ? `[${value.join(', ')}]` : typeof value === 'string' ? JSON.stringify(value) : String(value);
}

function valueOf(values, section, key) {
  return section.split('.').reduce((table, name) => table?.[name], values)?.[key];
}

/** A slider's ends: the whole range, or where that is far wider than the value at the start, the values around that. */
function sliderEnds({min, max}, start) {
  const reach = 4 * Math.abs(start) || 100;
  if (max - min <= 10 * reach) return [min, max];
  return [Math.max(min, start - reach), Math.min(max, start + reach)];
}

class Control {
  /** `send(key, text, done)` sets; `reset(key)` takes back. */
  constructor(section, shape, send, reset) {
    this.key = `${section}.${shape.key}`;
    Object.assign(this, {section, shape, send});
    const {name, unit} = nameAndUnit(shape.key);
    const id = this.key.replaceAll('.', '-');
    this.problem = make('p', {class: 'problem', role: 'alert', hidden: true});
    this.note = make('p', {class: 'note', hidden: true});
    this.back = make('button', {type: 'button', class: 'reset', hidden: true, title: 'Back to the value at the start',
      'aria-label': `Reset ${name}`, onclick: () => reset(this.key)}, '↺');
    this.label = make('label', {for: id}, name);
    this.element = make('div', {class: `control of-${shape.kind}`, 'data-key': this.key, title: this.range(unit)},
      this.label, ...this.inputs(id, name), make('span', {class: 'unit'}, unit), this.back, this.note, this.problem);
  }

  range(unit) {
    const {min, max, kind, word} = this.shape;
    const range = kind === 'flag' || kind === 'choice' ? '' : `: ${min} to ${max} ${unit}${word ? ` or ${word}` : ''}`;
    return `${this.key}${range}`;
  }

  inputs(id, name) {
    const {kind, names, min, max} = this.shape;
    const set = () => this.set();
    if (kind === 'flag') this.input = make('input', {id, type: 'checkbox', onchange: set});
    else if (kind === 'choice') {
      this.input = make('select', {id, onchange: set}, ...names.map((each) => make('option', {}, each)));
    } else if (kind === 'list') this.input = make('input', {id, type: 'text', onchange: set});
    else {
      this.input = make('input', {id, type: 'text', inputmode: 'decimal', onchange: set});
      this.slider = make('input', {type: 'range', 'aria-label': `${name}, slider`, oninput: () => {
        this.input.value = this.slider.value;
        this.set();
      }});
      Object.assign(this.slider, {min, max});
      return [this.slider, this.input];
    }
    return [this.input];
  }

  text() {
    const {kind} = this.shape;
    if (kind === 'flag') return String(this.input.checked);
    if (kind === 'choice') return JSON.stringify(this.input.value);
    return kind === 'list' ? `[${this.input.value}]` : this.input.value.trim();
  }

  set() {
    this.send(this.key, this.text(), (answer) => this.tell(answer.type === 'refused' ? answer.why : ''));
  }

  /** Why the value was refused. */
  tell(why) {
    this.problem.textContent = why;
    this.problem.hidden = !why;
    this.input.toggleAttribute('aria-invalid', Boolean(why));
  }

  /** The program's value, unless it is being typed. */
  show(value, start) {
    const isChanged = asToml(value) !== asToml(start);
    this.back.hidden = !isChanged;
    this.element.classList.toggle('changed', isChanged);
    if (this.slider) this.showSlider(value, start);
    const isTyped = document.activeElement === this.input && this.input.type === 'text';
    if (isTyped || this.input.hasAttribute('aria-invalid')) return;
    if (this.shape.kind === 'flag') this.input.checked = value;
    else this.input.value = Array.isArray(value) ? value.join(', ') : value;
  }

  /** Whether it acts in this scene, or with what it would. */
  showIdle(actsWith) {
    this.element.classList.toggle('idle', Boolean(actsWith));
    this.note.textContent = actsWith ? `Without effect here: acts with ${actsWith}` : '';
    this.note.hidden = !actsWith;
  }

  showSlider(value, start) {
    if (document.activeElement === this.slider) return;
    const [low, high] = sliderEnds(this.shape, start);
    const step = this.shape.kind === 'integer' ? 1 : 10 ** Math.floor(Math.log10((high - low) / 200));
    const ends = {min: low.toPrecision(6), max: high.toPrecision(6), step};
    Object.assign(this.slider, {...ends, value: value === this.shape.word ? low : value});
  }
}

class Controls {
  constructor(sections, send, reset) {
    this.controls = sections.flatMap(({section, controls}) =>
      controls.map((shape) => new Control(section, shape, send, reset)));
    this.filter = make('input', {type: 'search', placeholder: 'Find a setting', 'aria-label': 'Find a setting',
      oninput: () => this.find()});
    this.resetAll = make('button', {type: 'button', onclick: () => reset()}, 'Reset all');
    this.sections = sections.map(({section}) => make('details',
      {open: ['render', 'render.view', 'render.ray_casting', 'render.shading'].includes(section), 'data-section': section},
      make('summary', {}, sectionName(section)),
      ...this.controls.filter((control) => control.section === section).map(({element}) => element)));
    const isOfRenderer = (details) => details.dataset.section.startsWith('render');
    const scan = this.sections.filter((details) => !isOfRenderer(details));
    this.elements = [make('div', {class: 'tools'}, this.filter, this.resetAll),
      make('h2', {}, 'Renderer'), ...this.sections.filter(isOfRenderer),
      ...(scan.length ? [make('h2', {}, 'Scan'), make('p', {class: 'hint'}, 'A change begins a new stream.'), ...scan] : [])];
  }

  find() {
    const wanted = this.filter.value.trim().toLowerCase().replaceAll(' ', '_');
    for (const {element, key} of this.controls) element.hidden = !key.includes(wanted);
    for (const details of this.sections) {
      details.hidden = ![...details.querySelectorAll('.control')].some((element) => !element.hidden);
      if (wanted) details.open = true;
    }
  }

  show({values, start, idle}) {
    for (const control of this.controls) {
      const {section, shape} = control;
      control.showIdle(idle[control.key]);
      control.show(valueOf(values, section, shape.key), valueOf(start, section, shape.key));
    }
  }

  /** A setting that is not changed by its own control loses what was said of it. */
  clear(key) {
    for (const control of this.controls) if (!key || control.key === key) control.tell('');
  }
}
