// Two pictures of one size: swipe, onion skin, difference, side by side.

const comparisonModes = [['swipe', 'Swipe'], ['side', 'Side by side'], ['onion', 'Onion skin'], ['difference', 'Difference']];

class Comparison {
  constructor(figure) {
    this.pair = figure.querySelector('.pair');
    this.range = make('input', {type: 'range', min: '0', max: '100', step: '0.5', value: '50',
      'aria-label': 'Share of the left picture', oninput: () => this.setShare(Number(this.range.value))});
    const modes = choice('How to compare', comparisonModes.map(([, name]) => name),
      (index) => this.setMode(comparisonModes[index][0]));
    this.pair.before(modes);
    this.pair.after(this.range);
    this.pair.querySelectorAll('img').forEach((image) => { image.draggable = false; });
    this.pair.addEventListener('pointerdown', (event) => this.drag(event));
    this.pair.addEventListener('pointermove', (event) => { if (event.buttons & 1) this.drag(event); });
    this.setMode('swipe');
    this.setShare(50);
  }

  setMode(mode) {
    this.mode = mode;
    this.pair.dataset.mode = mode;
    this.range.hidden = mode !== 'swipe' && mode !== 'onion';
  }

  /** Of the left picture, in percent: its width in a swipe, its opacity in an onion skin. */
  setShare(percent) {
    this.range.value = String(percent);
    this.pair.style.setProperty('--share', String(percent / 100));
  }

  drag(event) {
    if (this.mode !== 'swipe') return;
    if (event.type === 'pointerdown') this.pair.setPointerCapture(event.pointerId);
    const box = this.pair.getBoundingClientRect();
    this.setShare(Math.min(100, Math.max(0, 100 * (event.clientX - box.left) / box.width)));
  }
}
