// Times of the live page, to be run by hand: node live_measure.js [IMAGE_SIZE …] with the environment of browser.js
// and PAGES_PROGRAM. No test: they depend on the machine and on what else it does.
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {loadavg} from 'node:os';
import {test} from 'node:test';

import {newPage, open} from './browser.js';

const sizes = process.argv.slice(2).map(Number).filter(Boolean);
const changes = Number(process.env.PAGES_LIVE_CHANGES ?? 60);

function quantile(values, share) {
  const sorted = [...values].sort((one, other) => one - other);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

/** Median and P95 of what the page measures while `key` takes one value after the other. */
async function measure(page, key, values) {
  const took = () => page.evaluate(() => JSON.parse(document.body.dataset.took ?? '[]').length);
  const control = page.locator(`[data-key="${key}"] input[type="text"]`);
  const all = [];
  for (const value of values) {
    const before = await took();
    await control.fill(String(value));
    await control.press('Enter');
    await page.waitForFunction((count) => JSON.parse(document.body.dataset.took ?? '[]').length > count, before, {polling: 20});
    all.push(await page.evaluate(() => JSON.parse(document.body.dataset.took).at(-1)));
  }
  const quantiles = (at) => [0.5, 0.95].map((q) => quantile(all.slice(1).map((each) => each[at]), q).toFixed(0)).join(', ');
  return {begin: all[0][1].toFixed(0), first: quantiles(0), whole: quantiles(1)};
}

const spread = (low, high) => Array.from({length: changes}, (_, index) => (low + (high - low) * (index * 37 % changes) / changes).toFixed(3));

for (const size of sizes.length ? sizes : [512, 256]) {
  test(`${size} x ${size}`, async () => {
    const child = spawn(process.env.PAGES_PROGRAM, ['live', '--port', '0', '--set', `render.ray_casting.image_size=${size}`,
      ...(process.env.PAGES_LIVE_ARGS ?? '').split(' ').filter(Boolean)], {stdio: ['ignore', 'pipe', 'inherit']});
    try {
      const address = String((await once(child.stdout, 'data'))[0]).split('\n')[0];
      const {context, page} = await newPage(() => true);
      await open(page, address);
      await page.waitForFunction(() => Number(document.querySelector('.picture canvas')?.dataset.volume) > 0);
      for (const playing of [true, false]) {
        if (!playing) await page.getByRole('button', {name: 'Pause'}).click();
        for (const [key, values] of [['render.shading.light_left_deg', spread(-60, 60)], ['render.ray_casting.threshold', spread(0.1, 0.2)],
          ['render.view.yaw_deg', spread(-40, 40)]]) {
          const {begin, first, whole} = await measure(page, key, values);
          console.log(`${size}, ${playing ? 'playing' : 'paused'}, ${key}: median, P95 ${first} ms, of all pixels ${whole} ms, first change ${begin} ms; `
            + `load ${loadavg()[0].toFixed(1)}`);
        }
      }
      await context.close();
    } finally {
      child.kill('SIGKILL');
    }
  });
}
