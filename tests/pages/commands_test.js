// The page of each command, on small scenes.
import assert from 'node:assert/strict';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';

import {checkScreen, desktop, linesOf, phone, scratch, withPage} from './browser.js';

const folder = scratch('commands');
const scene = `phantom = { name = "sphere", voxel_mm = 2 }
acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }
simulation.fidelity = "geometry"
render.scan_conversion.slice_size = 64
render.ray_casting.image_size = 64
`;
const plan = `design = "sobol"
points = 2
seeds = 1
repeats = 1
[scenes.ball]
${scene}[unseen.ball]
${scene}[axes]
"render.ray_casting.steps" = [32, 64]
"render.ray_casting.iso_level" = { from = 0.5, to = 0.9 }
`;
writeFileSync(join(folder, 'scene.toml'), scene);
writeFileSync(join(folder, 'plan.toml'), plan);

// What that level changes is allowed.
const limitsFile = join(folder, 'limits.toml');
writeFileSync(limitsFile, '[limits]\np95_mm = { worse_by = 9 }\n');
const sceneFile = join(folder, 'scene.toml');
const planFile = join(folder, 'plan.toml');
const commands = [['run', sceneFile], ['stream', sceneFile, '--volumes', '3'], ['record', sceneFile, '--volumes', '2'],
  ['rehearse', '--seeds', '5'], ['phantom', sceneFile], ['accuracy', sceneFile, '--seeds', '2'], ['trade', planFile],
  ['compare', 'this', 'this', '--scene', sceneFile, '--seeds', '1', '--new-set', 'render.ray_casting.iso_level=0.71',
    '--limits', limitsFile], ['score', join(folder, 'run/depth.exr'), '--scene', join(folder, 'run/report.json')],
  ['conformance', sceneFile],
  ['tables', '--divisor', '8', '--repeats', '1', '--set', 'phantom.name=sphere', '--set', 'phantom.voxel_mm=2',
    '--set', 'acquisition.sticks_per_frame=8'], ['latency', sceneFile, '--volumes', '10'], ['extremes'],
  ['fit', sceneFile, '--seeds', '1'], ['tune', planFile, '--limit', 'p95_mm<=20', '--evaluations', '2', '--random'],];

// Their pages begin with what was asked, in figures.
const answering = ['run', 'stream', 'accuracy', 'trade', 'compare', 'score', 'latency', 'tune'];

function make(command) {
  const out = scratch(join('commands', command[0]));
  linesOf(process.env.PAGES_PROGRAM, [...command, '--out', out]);
  return join(out, 'report.html');
}

for (const command of commands) {
  test(`the page of ${command[0]} is accessible, fits every screen, and names its command`, async () => {
    const page = make(command);
    await checkScreen(page, phone, 'dark');
    await checkScreen(page, desktop, 'light', async (shown) => {
      const line = await shown.locator('main > .command-row pre.command').last().textContent();
      assert.ok(line.startsWith(`wobblebench ${command[0]}`), line);
      if (!answering.includes(command[0])) return;
      assert.equal(await shown.locator('main :is(dl.key-figures, figure)').first().evaluate((it) => it.tagName), 'DL');
    });
  });
}

test('each point of accuracy names a command that makes its picture', () =>
  withPage(join(folder, 'accuracy/report.html'), async (page) => {
    const commands = await page.evaluate(() => [...document.querySelectorAll('template.detail')]
      .map(({content}) => content.querySelector('pre.command').textContent));
    assert.ok(commands.length > 0);
    const [, ...words] = commands[0].split(' ');
    linesOf(process.env.PAGES_PROGRAM, [...words, '--out', scratch('point')]);
  }));

test('a click on the front of a trade shows the command of its point', () =>
  withPage(join(folder, 'trade/report.html'), async (page) => {
    const points = page.locator('figure.chart svg .mark-symbol.role-mark path');
    for (let i = 0; i < await points.count(); ++i) {
      const id = await points.nth(i).evaluate((element) => element.__data__.datum.id ?? null);
      if (id === null) continue;
      await points.nth(i).click({force: true});
      assert.match(await page.locator('aside.detail pre.command').textContent(), /^wobblebench /);
      return;
    }
    assert.fail('no point of a chart has an id');
  }));
