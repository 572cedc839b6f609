// Time lines: the last pictures' times, ages, losses and errors.

const mostPoints = 120;

/** A line of numbers over the last pictures. */
class TimeLine {
  constructor(name, unit, digits = 0) {
    Object.assign(this, {unit, digits, values: []});
    this.now = make('span', {class: 'now'}, '–');
    this.svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.svg.setAttribute('viewBox', '0 0 240 36');
    this.svg.setAttribute('preserveAspectRatio', 'none');
    this.svg.setAttribute('aria-hidden', 'true');
    this.line = document.createElementNS('http://www.w3.org/2000/svg', 'polyline');
    this.svg.append(this.line);
    this.most = make('span', {class: 'most'});
    this.element = make('div', {class: 'time-line'}, make('span', {class: 'name'}, name), this.now, this.svg, this.most);
  }

  add(value) {
    this.values.push(value);
    if (this.values.length > mostPoints) this.values.shift();
    const text = (number) => `${number.toFixed(this.digits)} ${this.unit}`;
    this.now.textContent = value === null ? '–' : text(value);
    const most = Math.max(...this.values.filter((each) => each !== null), 0);
    this.most.textContent = most > 0 ? `max ${text(most)}` : '';
    const points = this.values.map((each, index) => each === null ? '' :
      `${(240 - 240 * (this.values.length - 1 - index) / (mostPoints - 1)).toFixed(1)},${(34 - 32 * each / (most || 1)).toFixed(1)}`);
    this.line.setAttribute('points', points.filter(Boolean).join(' '));
  }
}

class Times {
  constructor(hasTruth) {
    const line = (name, unit, digits) => new TimeLine(name, unit, digits);
    this.lines = {rate: line('Pictures of volumes', '/s', 1), picture: line('Scan conversion to smoothing', 'ms', 1),
      oldest: line('Age of the oldest echo', 'ms'), newest: line('Age of the newest echo', 'ms'),
      browser: line('Setting to picture on this page', 'ms'), lost: line('Sticks lost', '/volume'),
      ...(hasTruth ? {error: line('Depth error, P95 (with Error)', 'mm', 2)} : {})};
    this.passes = make('p', {class: 'passes'});
    this.limit = make('p', {class: 'limit'});
    this.account = make('p', {class: 'account'});
    this.brief = make('p', {class: 'brief'});  // beside the picture, which the lines are below
    this.element = make('section', {class: 'times', 'aria-label': 'Times'},
      this.limit, ...Object.values(this.lines).map(({element}) => element), this.passes, this.account);
  }

  take(times) {
    const lost = Object.entries(times.board).filter(([name, count]) => name.startsWith('lost_') && count > 0);
    Object.assign(times, {sticks: times.board.emitted, causes: lost, lost: lost.reduce((sum, [, count]) => sum + count, 0)});
    const busy_ms = Object.values(times.passes).reduce((sum, ms) => sum + ms, 0);
    // A new stream counts from 0.
    const before = this.last && this.last.sticks < times.sticks ? this.last : null;
    this.lines.rate.add(before ? 1000 * (times.pictures - before.pictures) / (times.ready_ms - before.ready_ms) : null);
    this.lines.picture.add(busy_ms);
    this.lines.oldest.add(times.age_oldest_ms);
    this.lines.newest.add(times.age_newest_ms);
    this.lines.lost.add(before ? Math.max(0, times.lost - before.lost) : times.lost);
    this.last = times;
    this.tell(times, busy_ms);
  }

  tell(times, busy_ms) {
    this.passes.textContent = Object.entries(times.passes)
      .map(([name, ms]) => `${name.replaceAll('_', ' ')} ${ms.toFixed(1)} ms`).join(', ');
    const waits = times.waited_ms > busy_ms / 20;
    const sound = times.sound_ms === null ? 'an unknown time' : `${times.sound_ms.toFixed(0)} ms`;
    this.limit.textContent = `${waits ? 'The sound is the limit' : 'The renderer is the limit'}: one volume takes `
      + `${sound} to fire and ${busy_ms.toFixed(0)} ms to render.`;
    const lost = times.causes.map(([name, count]) => `${count} ${name.slice('lost_'.length).replaceAll('_', ' ')}`);
    const age = (ms) => `${ms.toFixed(0)} ms`;
    this.brief.textContent = `Newest echo ${age(times.age_newest_ms)} old, oldest ${age(times.age_oldest_ms)}; `
      + `sticks lost: ${times.lost}; volumes waiting: ${times.waiting_volumes}`;
    this.account.textContent = `This stream: volume ${times.volume}, ${times.sticks} sticks, `
      + `${lost.length ? `lost ${lost.join(', ')}` : 'none lost'}; ${times.superseded_volumes} volumes superseded, `
      + `${times.waiting_volumes} in the queue.`;
  }
}
