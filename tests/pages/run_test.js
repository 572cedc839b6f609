// The page that `wobblebench run` writes, against its files.
import assert from 'node:assert/strict';
import {statSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';

import {checkScreen, desktop, linesOf, phone, readMap, scratch, withPage} from './browser.js';

const folder = scratch('run');
const report = join(folder, 'report.html');
// The defaults: speckle, which compresses badly, and the size of pictures.
before(() => linesOf(process.env.PAGES_PROGRAM, ['run', '--out', folder]));

test('the page is accessible, fits every screen, and is below 3 MB', async () => {
  assert.ok(statSync(report).size < 3e6, `${statSync(report).size}`);
  await checkScreen(report, desktop, 'light');
  await checkScreen(report, phone, 'dark');
});

/** Pixels that any two runs of the test share. */
function pixels(count, width, height) {
  let state = 12345;
  const below = (end) => {
    state = state * 16807 % 2147483647;  // Park and Miller's
    return state % end;
  };
  return Array.from({length: count}, () => ({column: below(width), row: below(height)}));
}

test('millimetres under the pointer are those of the EXR files', () => withPage(report, async (page) => {
  const map = page.locator('figure.map').first();
  const data = JSON.parse(await map.locator('script').textContent());
  const files = {'signed error': 'error_depth.exr', 'found depth': 'depth.exr', 'true depth': 'truth_depth.exr'};
  const chosen = pixels(200, data.width, data.height);
  for (const [layer, {name, step}] of data.layers.entries()) {
    const expected = linesOf(process.env.PAGES_EXR,
      [join(folder, files[name]), ...chosen.flatMap(({column, row}) => [String(column), String(row)])]);
    let compared = 0;
    for (const [index, {column, row}] of chosen.entries()) {
      if (compared === 10) break;
      const {values} = await readMap(page, map, column, row);
      if (expected[index] === 'null') {
        assert.equal(values[layer], null, `${name} at ${column} ${row}`);
      } else {
        assert.ok(Math.abs(values[layer] - Number(expected[index])) <= 0.51 * step, `${name} at ${column} ${row}`);
        ++compared;
      }
    }
    assert.equal(compared, 10, name);
  }
}));
