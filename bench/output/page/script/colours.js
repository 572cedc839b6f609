// Colours of maps: ends and steps between that people with any colour vision tell apart.

const colourStops = {
  // ColorBrewer's RdBu, blue first.
  diverging: ['#053061', '#2166ac', '#4393c3', '#92c5de', '#d1e5f0', '#f7f7f7', '#fddbc7', '#f4a582', '#d6604d',
    '#b2182b', '#67001f'],
  // Matplotlib's viridis.
  sequential: ['#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b',
    '#fde725'],
};

/** "#d55e00" as [213, 94, 0]. */
function rgb(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}

/** 256 colours, from the lowest value to the highest, as [red, green, blue]. */
function colourTable(kind) {
  const stops = (colourStops[kind] ?? colourStops.sequential).map(rgb);
  return Array.from({length: 256}, (_, index) => {
    const at = index / 255 * (stops.length - 1);
    const below = Math.min(Math.floor(at), stops.length - 2);
    return stops[below].map((value, channel) =>
      Math.round(value + (at - below) * (stops[below + 1][channel] - value)));
  });
}

/** Round numbers from low to high, about `count` of them. */
function roundTicks(low, high, count = 6) {
  const raw = (high - low) / count;
  if (!(raw > 0) || !Number.isFinite(raw)) return [];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({length: last - first + 1}, (_, index) => (first + index) * step);
}

/** Digits after the point that tell a thousandth of a range apart. */
function digitsFor(low, high) {
  const step = Math.abs(high - low) / 1000;
  return step > 0 && Number.isFinite(step) ? Math.min(6, Math.max(0, Math.ceil(-Math.log10(step)))) : 2;
}
