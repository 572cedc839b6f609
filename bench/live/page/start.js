// The page: what the parts are connected by.

const stages = {preparing: 'Preparing the stream …', playing: 'Playing', paused: 'Paused', ended: 'The stream has ended', waiting: 'Waiting for a page'};
const rareFaults = {unplug: 0.0002, stall: 0.0005, delay: 0.001};

class Page {
  constructor() {
    this.wanted = {maps: false, planes: false, space: false};
    this.sentAt = new Map();
    this.link = new Link((header, parts) => this.take(header, parts), (isOpen) => this.opened(isOpen));
    this.sender = new Sender(this.link);
  }

  element(id) {
    return document.getElementById(id);
  }

  opened(isOpen) {
    document.body.classList.toggle('offline', !isOpen);
    if (isOpen) this.greet();
    else this.element('stage').textContent = 'The program does not answer; trying again …';
  }

  async greet() {
    const {id, ...hello} = await this.link.ask({do: 'hello'});
    if (hello.type !== 'hello') {
      // The first stream is being prepared.
      if (this.link.isOpen()) setTimeout(() => this.greet(), 500);
      return;
    }
    // Another program than before has other controls.
    const known = JSON.stringify(hello);
    if (this.controls && known !== this.known) location.reload();
    this.known = known;
    if (!this.controls) {
      this.build(hello);
      await this.setFromLink();
    }
    this.link.ask({do: 'show', ...this.wanted});
  }

  build(hello) {
    const set = (key, text, done) => this.set(key, text, done);
    this.controls = new Controls(hello.controls, set, (key) => this.reset(key));
    this.picture = new Picture((key, value) => this.turn(key, value), (maps) => this.want({maps}), hello.has_truth);
    this.planes = new Planes((planes) => this.want({planes}));
    this.space = new Space((space) => this.want({space}));
    this.past = new Past((request) => this.link.ask(request), () => this.movePast());
    this.compared = new Compared(() => this.link.ask({do: 'compare'}), (isOn) => this.picture.cover(isOn));
    this.picture.stage.after(this.compared.element);
    this.times = new Times(hello.has_truth);
    this.warnings = make('div', {class: 'warnings', hidden: true});
    this.element('source').textContent = `${hello.scene || 'default scene'} · --board ${hello.board} · ${hello.renderer}`;
    const transport = this.transport();
    this.saveButton.after(this.compared.button);
    this.element('view').replaceChildren(transport, this.warnings, this.times.brief, this.picture.element, this.past.element,
      this.faults(hello.faults), this.planes.element, this.space.element, this.times.element);
    this.element('panel').replaceChildren(...this.controls.elements);
    document.body.append(statusLine);
    if (this.status) this.showStatus(this.status);
  }

  transport() {
    const ask = (what) => () => this.link.ask({do: what});
    this.play = make('button', {type: 'button', class: 'play', onclick: () => this.link.ask({do: this.isPlaying ? 'pause' : 'play'})}, 'Pause');
    this.step = make('button', {type: 'button', onclick: ask('step')}, 'One volume');
    this.frame = make('button', {type: 'button', title: 'Turn the view and lay the box about the head that the echoes show',
      onclick: () => this.frameHead()}, 'Frame the head');
    this.saveButton = make('button', {type: 'button', onclick: () => this.save()}, 'Save scene');
    this.savedText = make('div', {class: 'saved', hidden: true});
    return make('div', {}, make('div', {class: 'tools transport'}, this.play, this.step, this.frame, this.saveButton), this.savedText);
  }

  faults(kinds) {
    this.faultButtons = kinds.map((kind) => make('button', {type: 'button', 'aria-pressed': 'false', 'data-fault': kind,
      onclick: ({target}) => {
        target.setAttribute('aria-pressed', String(target.getAttribute('aria-pressed') !== 'true'));
        this.sendFaults();
      }}, kind.replaceAll('_', ' ')));
    this.faultText = make('code', {class: 'terms'});
    return make('fieldset', {class: 'faults'}, make('legend', {}, 'Faults of the link'), ...this.faultButtons, this.faultText);
  }

  sendFaults() {
    const pressed = this.faultButtons.filter((button) => button.getAttribute('aria-pressed') === 'true');
    const terms = pressed.map(({dataset}) => `${dataset.fault}:${rareFaults[dataset.fault] ?? 0.01}`);
    this.link.ask({do: 'faults', faults: terms.join('+')});
  }

  /** The settings that the page's address holds behind #. */
  async setFromLink() {
    const settings = location.hash.slice(1).split('&').filter(Boolean).map(decodeURIComponent);
    this.linked = true;
    if (settings.length === 0) return;
    const answer = await this.link.ask({do: 'set', settings});
    if (answer.type === 'refused') this.tell(`The address holds settings that were not taken: ${answer.why}`);
  }

  async frameHead() {
    const answer = await this.link.ask({do: 'frame'});
    this.tell(answer.type === 'refused' ? answer.why : '');
  }

  tell(text) {
    const line = this.element('link');
    line.textContent = text;
    line.hidden = !text;
  }

  /** A link carries what is set. */
  showInAddress(settings) {
    if (!this.linked) return;
    const hash = settings.map((setting) => encodeURIComponent(setting).replaceAll('%3D', '=')).join('&');
    const address = location.pathname + location.search + (hash ? `#${hash}` : '');
    if (address !== location.pathname + location.search + location.hash) history.replaceState(null, '', address);
  }

  /** The cursor of the last minute has moved, or is back at now. */
  movePast() {
    const isPast = this.past.volume !== null;
    this.element('view').classList.toggle('at-past', isPast);
    this.picture.setPast(isPast);
    this.wantPast();
    if (!isPast) this.link.ask({do: 'show', ...this.wanted});
  }

  wantPast() {
    if (this.past.volume === null) return;
    this.past.want(['picture', ...(this.wanted.maps ? ['maps'] : []), ...(this.wanted.planes ? ['planes'] : [])]);
  }

  set(key, text, done = () => {}) {
    this.sender.set(key, text, (answer) => {
      if (answer.serial) this.sentAt.set(answer.serial, answer.since);
      done(answer);
    });
  }

  /** Angles of the picture: a refusal stands in their controls. */
  turn(key, value) {
    const control = this.controls.controls.find((each) => each.key === key);
    this.set(key, String(value), (answer) => control?.tell(answer.type === 'refused' ? answer.why : ''));
  }

  reset(key) {
    this.controls.clear(key);
    this.link.ask({do: 'reset', keys: key ? [key] : []});
  }

  want(change) {
    Object.assign(this.wanted, change);
    this.link.ask({do: 'show', ...this.wanted});
    this.wantPast();
  }

  async take(header, parts) {
    if (header.type === 'status') return this.showStatus(header);
    if (!this.controls) return undefined;
    if (header.type === 'times') return this.times.take(header);
    if (header.type === 'space') return this.space.take(header, parts);
    if (header.type === 'firing') return this.space.takeFrame(header);
    if (header.type === 'compared') return this.compared.take(header, parts);
    if (header.type === 'maps') this.times.lines.error?.add(header.p95_mm ?? null);
    if (header.type === 'past') {
      const within = this.past.take(header, parts);
      return within && this.draw(within.header, within.parts);
    }
    if (this.past.volume !== null) return undefined;
    await this.draw(header, parts);
    return header.type === 'picture' ? this.measure(header) : undefined;
  }

  /** A message of what is shown, live or of an earlier volume. */
  draw(header, parts) {
    if (header.type === 'planes') return this.planes.take(header, parts);
    if (header.type === 'maps') return this.picture.takeMaps(header, parts);
    return this.picture.takePicture(header, parts);
  }

  /** The time from a setting to its picture, the first one and that of all pixels. */
  measure({serial, coarse}) {
    const answered = [...this.sentAt].filter(([each]) => each <= serial);
    if (answered.length === 0) return;
    const took = performance.now() - Math.max(...answered.map(([, since]) => since));
    if (coarse) {
      this.first = took;
      return;
    }
    for (const [each] of answered) this.sentAt.delete(each);
    this.times.lines.browser.add(this.first ?? took);
    (this.took ??= []).push([this.first ?? took, took]);
    this.first = null;
    if (this.took.length > 1000) this.took.shift();
    document.body.dataset.took = JSON.stringify(this.took);
  }

  showStatus(status) {
    this.status = status;
    this.isPlaying = ['playing', 'preparing'].includes(status.stage);
    this.element('stage').textContent = stages[status.stage];
    this.element('why').textContent = status.why;
    this.element('why').hidden = !status.why;
    document.body.dataset.serial = status.serial;
    if (!this.controls) return;
    this.play.textContent = this.isPlaying ? 'Pause' : 'Play';
    this.picture.values = status.values;
    this.space.setBox(status.values.render.volume_of_interest);
    this.compared.follow(status.serial);
    this.showInAddress(status.settings);
    this.warnings.replaceChildren(...status.warnings.map((warning) => make('p', {}, warning)));
    this.warnings.hidden = status.warnings.length === 0;
    this.faultText.textContent = status.faults;
    this.controls.show(status);
    const on = new Set(status.faults.split('+').map((term) => term.split(/[:@]/)[0]));
    for (const button of this.faultButtons) button.setAttribute('aria-pressed', String(on.has(button.dataset.fault)));
  }

  async save() {
    const saved = await this.link.ask({do: 'save'});
    this.savedText.hidden = false;
    if (saved.type !== 'saved') {
      this.savedText.replaceChildren(make('p', {class: 'problem', role: 'alert'}, saved.why));
      return;
    }
    const file = (name, text, type) => make('a', {download: name, href: URL.createObjectURL(new Blob([text], {type}))}, name);
    const picture = make('a', {download: 'surface.png', href: `data:image/png;base64,${saved.picture}`}, 'surface.png');
    const command = make('pre', {class: 'command', tabindex: '0'}, saved.command);
    const scene = file('scene.toml', saved.toml, 'application/toml');
    this.savedText.replaceChildren(make('p', {}, 'Download ', scene, ' and the picture ', picture, '. This command makes it again:'), command,
      ...(saved.why_not_the_same ? [make('p', {class: 'problem'}, `Not to the byte: ${saved.why_not_the_same}.`)] : []),
      make('details', {}, make('summary', {}, 'scene.toml'), make('pre', {class: 'toml', tabindex: '0'}, saved.toml)));
    addCopyButton(command);
    announce('The scene is saved');
  }
}

new Page();
