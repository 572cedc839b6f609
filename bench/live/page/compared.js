// The picture beside that of the settings at the start, of the same volume.

class Compared {
  /** `ask()` asks for the two; `changed(isOn)` is told when the comparison begins or ends. */
  constructor(ask, changed) {
    Object.assign(this, {ask, changed, isOn: false, isAsked: false});
    this.button = make('button', {type: 'button', 'aria-pressed': 'false', onclick: () => this.toggle()}, 'Compare with start');
    const image = (side, alt) => make('img', {'data-side': side, alt});
    this.images = [image('left', 'The picture by the settings now'), image('right', 'The picture by the settings at the start')];
    this.text = make('figcaption', {});
    this.element = make('figure', {class: 'comparison compared', hidden: true}, make('div', {class: 'pair'}, ...this.images), this.text);
    this.comparison = new Comparison(this.element);
  }

  toggle() {
    this.isOn = !this.isOn;
    this.button.setAttribute('aria-pressed', String(this.isOn));
    this.element.hidden = true;
    this.isAsked = false;
    this.changed(this.isOn);
    this.follow(null);
  }

  /** The settings have changed: both are made again, when the two before have come. */
  follow(serial) {
    if (serial !== null) this.serial = serial;
    if (!this.isOn || this.isAsked || this.shown === this.serial && serial !== null) return;
    this.isAsked = true;
    this.ask();
  }

  async take({serial, volume}, parts) {
    if (!this.isOn) return;
    parts.forEach((part, index) => {
      URL.revokeObjectURL(this.images[index].src);
      this.images[index].src = URL.createObjectURL(new Blob([part], {type: 'image/jpeg'}));
    });
    await Promise.all(this.images.map((image) => image.decode()));
    this.text.textContent = `Volume ${volume}: left by the settings now, right by those at the start.`;
    Object.assign(this, {shown: serial, isAsked: false});
    this.element.hidden = false;
    this.element.dataset.serial = serial;
    this.follow(this.serial ?? serial);
  }
}
