// The last minute: a cursor over the volumes that the program keeps, and their slow motion.

const slowness = 4;
const patience_ms = 2000;

class Past {
  /** `ask(request)` gives the answer; `changed()` is told when the cursor leaves or reaches now, and of each step. */
  constructor(ask, changed) {
    Object.assign(this, {ask, changed, volumes: null, index: 0, wanted: []});
    this.range = make('input', {type: 'range', min: '0', max: '100', value: '100', 'aria-label': 'Volume of the last minute',
      oninput: () => this.move(Number(this.range.value), Number(this.range.max))});
    this.text = make('span', {class: 'when'}, 'now');
    this.back = make('button', {type: 'button', hidden: true, onclick: () => this.leave()}, 'Back to now');
    this.slow = make('button', {type: 'button', onclick: () => this.toggleSlow()}, 'Slow motion ¼');
    this.element = make('div', {class: 'past', role: 'group', 'aria-label': 'The last minute'},
      make('span', {class: 'name'}, 'Last minute'), this.range, this.text, this.slow, this.back);
  }

  /** The volume under the cursor; null: now. */
  get volume() {
    return this.volumes?.[this.index] ?? null;
  }

  async enter() {
    if (this.volumes) return true;
    const {volumes} = await this.ask({do: 'history'});
    if (!volumes?.length) {
      this.range.value = this.range.max;
      return false;
    }
    this.volumes = volumes;
    return true;
  }

  async move(value, most) {
    this.stopSlow();
    if (this.volumes) return this.show(value);
    if (!await this.enter()) return undefined;
    const last = this.volumes.length - 1;
    // One step of the keyboard is one volume.
    return this.show(most - value === 1 ? last - 1 : Math.round(last * value / most));
  }

  show(index) {
    this.index = within(index, 0, this.volumes.length - 1);
    Object.assign(this.range, {max: this.volumes.length - 1, value: this.index});
    const {volume, device_s} = this.volume;
    const ago_s = this.volumes.at(-1).device_s - device_s;
    this.text.textContent = `volume ${volume}, ${ago_s.toFixed(1)} s of device time before volume ${this.volumes.at(-1).volume}`;
    this.range.setAttribute('aria-valuetext', this.text.textContent);
    this.back.hidden = false;
    this.changed();
  }

  leave() {
    this.stopSlow();
    this.volumes = null;
    this.wanted = [];
    Object.assign(this.range, {max: 100, value: 100});
    this.range.removeAttribute('aria-valuetext');
    this.text.textContent = 'now';
    this.back.hidden = true;
    this.changed();
  }

  /** Asks for these of the volume under the cursor, one after the other: picture, maps, planes. */
  want(kinds) {
    this.wanted = kinds;
    this.askNext();
  }

  askNext() {
    clearTimeout(this.timer);
    if (!this.volume || this.wanted.length === 0) return;
    this.ask({do: 'past', number: this.volume.number, of: this.wanted[0]});
    // Another viewer's message may have taken the place of ours.
    this.timer = setTimeout(() => this.askNext(), patience_ms);
  }

  /** The message within one of an earlier volume; null: of another than the cursor's, or it is no longer kept. */
  take({number, of}, [part]) {
    if (number !== this.volume?.number || of !== this.wanted[0]) return null;
    this.wanted = this.wanted.slice(1);
    this.askNext();
    if (part) return unpack(part);
    if (of === 'picture') this.text.textContent = 'This volume is no longer kept.';
    return null;
  }

  async toggleSlow() {
    if (this.playing) return this.stopSlow();
    if (!await this.enter()) return undefined;
    this.slow.setAttribute('aria-pressed', 'true');
    this.playing = true;
    const atEnd = this.back.hidden || this.index >= this.volumes.length - 1;
    return this.stepSlow(atEnd ? 0 : this.index);
  }

  stepSlow(index) {
    this.show(index);
    const next = this.volumes[index + 1];
    if (!next) return this.stopSlow();
    const wait_s = Math.max(0, next.device_s - this.volumes[index].device_s);
    this.slowTimer = setTimeout(() => this.stepSlow(index + 1), 1000 * slowness * Math.min(wait_s, 2));
    return undefined;
  }

  stopSlow() {
    clearTimeout(this.slowTimer);
    this.playing = false;
    this.slow.setAttribute('aria-pressed', 'false');
  }
}
