// The live page: the last minute, the start beside now, space, links, warnings, the keyboard, and its memory.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {test} from 'node:test';

import {coloursAt} from './browser.js';
import {ask, checkSaved, live, pause, pictureOf, program, savedOf, sceneFile, set, shownPixels, start, volumeOf, within, withLive} from './live_program.js';

test('going back shows a volume, its picture, error and planes as they were', () => withLive(async (page) => {
  // Else one volume is as the other.
  await pictureOf(page, await set(page, ['motion.velocity_mm_s=[20, 0, 0]']));
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
  await pause(page);
  const pictures = [], errors = [];
  for (let i = 0; i < 4; ++i) {
    const before = Number((await shownPixels(page)).volume);
    await page.getByRole('button', {name: 'One volume'}).click();
    await volumeOf(page, before + 1);
    pictures.push(await shownPixels(page));
    await page.getByText('Error', {exact: true}).click();
    await page.waitForFunction((volume) => document.querySelector('.picture canvas').dataset.volume === String(volume)
      && document.querySelector('.picture').dataset.drawn === 'Error', before + 1);
    errors.push(await shownPixels(page));
    await page.getByText('Picture', {exact: true}).click();
  }
  assert.equal(new Set(pictures.map(({hash}) => hash)).size, 4);
  // A busy machine decodes slowly: the page is drawn again meanwhile.
  await page.evaluate(() => {
    const decode = window.createImageBitmap.bind(window);
    window.createImageBitmap = (image) => new Promise((done) => { setTimeout(() => done(decode(image)), 150); });
  });
  const cursor = page.locator('.past input');
  for (const [index, steps] of [[1, 2], [2, -1]]) {
    await cursor.focus();
    for (let i = 0; i < Math.abs(steps); ++i) {
      await cursor.press(steps > 0 ? 'ArrowLeft' : 'ArrowRight');
      await page.locator('.past .when').filter({hasText: 'before'}).waitFor();
    }
    const isAt = ({volume}) => page.waitForFunction((each) => document.querySelector('.picture canvas').dataset.volume === each
      && !document.querySelector('.stage.stale'), volume);
    await isAt(pictures[index]);
    assert.deepEqual(await shownPixels(page), pictures[index]);
    await page.getByText('Error', {exact: true}).click();
    await page.waitForFunction((volume) => document.querySelector('.picture canvas').dataset.volume === volume
      && document.querySelector('.picture').dataset.drawn === 'Error' && !document.querySelector('.stage.stale'), errors[index].volume);
    assert.deepEqual(await shownPixels(page), errors[index]);
    await page.getByText('Picture', {exact: true}).click();
  }
  await page.getByText('B-mode planes').click();
  await page.locator('.planes[data-ready]').waitFor();
  await page.getByRole('button', {name: 'Back to now'}).click();
  await page.waitForFunction((volume) => document.querySelector('.picture canvas').dataset.volume === volume, pictures[3].volume);
  assert.deepEqual(await shownPixels(page), pictures[3]);
  await page.getByRole('button', {name: 'Slow motion'}).click();
  await page.locator('.past .when').filter({hasText: ' 0.0 s of device time'}).waitFor();
  await page.getByRole('button', {name: 'Back to now'}).click();
  assert.match((await ask(page, {do: 'past', number: 1, of: 'passwords'})).why, /must be picture, maps or planes/);
}));

test('the head is framed upright, and where there is none a line says so', () => withLive(async (page) => {
  const frame = page.getByRole('button', {name: 'Frame the head'});
  await pictureOf(page, await set(page, ['phantom.name=fetal_face', 'phantom.voxel_mm=1', 'placement.rotation_deg=[0, 0, 90]',
    'acquisition.frames_per_volume=37', 'acquisition.sticks_per_frame=64', 'acquisition.samples_per_stick=512']));
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
  await frame.click();
  const roll = page.locator('[data-key="render.view.roll_deg"] input[type="text"]');
  await page.waitForFunction((element) => element.value !== '0', await roll.elementHandle());
  const found = Number(await roll.inputValue());  // the child's own head is rolled by -5 degrees
  assert.ok(found > 70 && found < 100, String(found));
  await pictureOf(page, await set(page, ['phantom.name=sphere']));
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
  await frame.click();
  await page.locator('#link').filter({hasText: 'no head was found'}).waitFor();
}));

test('the picture is compared with that of the start, of the same volume', () => withLive(async (page) => {
  await pause(page);
  const start = await savedOf(page, 0);
  const serial = await set(page, ['render.view.yaw_deg=40', 'render.shading.ambient=0.3', 'render.scan_conversion.slice_size=48']);
  await page.getByRole('button', {name: 'Compare with start'}).click();
  await page.waitForFunction((least) => Number(document.querySelector('.compared:not([hidden])')?.dataset.serial ?? -1) >= least, serial);
  const now = await savedOf(page, serial);
  const differences = await page.evaluate(async (pictures) => {
    const pixels = async (image) => {
      await image.decode();
      const canvas = Object.assign(document.createElement('canvas'), {width: image.naturalWidth, height: image.naturalHeight});
      canvas.getContext('2d').drawImage(image, 0, 0);
      return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    };
    const shown = await Promise.all([...document.querySelectorAll('.compared img')].map(pixels));
    const expected = await Promise.all(pictures.map((picture) => pixels(Object.assign(new Image(), {src: `data:image/png;base64,${picture}`}))));
    return shown.flatMap((one) => expected.map((other) => one.reduce((sum, byte, index) => sum + Math.abs(byte - other[index]), 0) / one.length));
  }, [now.picture, start.picture]);
  const [left, leftOfStart, rightOfNow, right] = differences;
  assert.ok(left < 3 && right < 3 && leftOfStart > 5 && rightOfNow > 5, String(differences));
  await page.getByRole('button', {name: 'Compare with start'}).click();
  await page.locator('.picture .stage').waitFor();
}));

test('a slow picture is shown with half the pixels first', async () => {
  const other = await start(['--gl', 'osmesa']);
  await withLive(async (page) => {
    await pause(page);
    await pictureOf(page, await set(page, ['render.ray_casting.image_size=1024']));
    await page.evaluate(() => {
      const stage = document.querySelector('.picture .stage');
      window.coarseWidths = [];
      new MutationObserver(() => {
        if (stage.classList.contains('coarse')) window.coarseWidths.push(stage.querySelector('canvas').width);
      }).observe(stage, {attributes: true, attributeFilter: ['class']});
    });
    let serial, coarse = [];
    // On a busy machine the whole picture may overtake it.
    for (let yaw = 1; yaw <= 20 && coarse.length === 0; ++yaw) {
      serial = await set(page, [`render.view.yaw_deg=${yaw}`]);
      await pictureOf(page, serial);
      coarse = await page.evaluate(() => window.coarseWidths);
    }
    assert.equal(coarse[0], 512);
    assert.equal(await page.locator('.picture canvas').evaluate(({width}) => width), 1024);
    assert.equal(await page.locator('.picture .coarse').count(), 0);
    checkSaved(await savedOf(page, serial), 'after_coarse');
  }, {address: other.address});
  other.child.kill();
});

test('a link carries what is set, through the checks of the command line', async () => {
  await withLive(async (page) => {
    await page.waitForFunction(() => ['render.view.roll_deg', 'render.shading.ambient']
      .map((key) => document.querySelector(`[data-key="${key}"] input[type="text"]`).value).join() === '17,0.3');
    assert.match(await page.evaluate(() => location.hash), /render\.view\.roll_deg=17/);
    const control = page.locator('[data-key="render.smoothing.filter"] select');
    await page.locator('[data-section="render.smoothing"] summary').click();
    await control.selectOption('guided');
    await page.waitForFunction(() => decodeURIComponent(location.hash).includes('render.smoothing.filter="guided"'));
    await page.getByRole('button', {name: 'Reset all'}).click();
    await page.waitForFunction(() => location.hash === '');
  }, {address: `${live.address}#render.view.roll_deg=17&render.shading.ambient=0.3`});
  for (const [hash, why] of [['render.view.roll_deg=900', /render\.view\.roll_deg = 900: must be/], ['phantom.file=/etc/passwd', /cannot be set/]]) {
    await withLive(async (page) => assert.match(await page.locator('#link:not([hidden])').textContent(), why),
      {address: `${live.address}#${hash}`});
  }
});

test('a rehearsal is replayed with the faults that it draws', async () => {
  const {stderr} = spawnSync(program, ['rehearse', '--first-seed', '4', '--seeds', '1', '--trace', '--out', within('rehearsal')],
    {encoding: 'utf8'});
  const drawn = stderr.split('\n').find((line) => line.includes(' volumes of ')).match(/\w+[:@][\d.e-]+/g);
  assert.ok(drawn.length > 1, stderr);
  const other = await start(['--replay', '4']);
  await withLive(async (page) => {
    const terms = (await page.locator('.faults .terms').textContent()).split('+');
    assert.deepEqual(terms.slice(0, -3), drawn);
    assert.match(terms.slice(-3).join(), /^seed:\d+,delay_ms:[\d.]+,stall_ms:[\d.]+$/);
    const pressed = await page.locator('.faults [aria-pressed="true"]').evaluateAll((buttons) => buttons.map(({dataset}) => dataset.fault));
    assert.deepEqual(pressed.sort(), drawn.map((term) => term.split(/[:@]/)[0]).sort());
    await page.locator('.times .account').filter({hasText: /lost \d+ .*corrupt/}).waitFor();
  }, {address: other.address});
  other.child.kill();
  for (const [args, why] of [[['--replay', '7'], /--replay = 7: this rehearsal has no faults/],
    [['--replay', '4', '--board', 'sim,faults=drop:0.1'], /--board has faults, too/]]) {
    const refused = spawnSync(program, ['live', sceneFile, '--port', '0', ...args], {encoding: 'utf8', timeout: 60_000});
    assert.equal(refused.status, 2);
    assert.match(refused.stderr, why);
  }
});

test('a setting that cannot act says with what it would', () => withLive(async (page) => {
  const eye = page.locator('[data-key="render.view.eye_distance_mm"]');
  await eye.filter({hasText: 'Without effect here: acts with render.view.projection = perspective'}).waitFor();
  assert.ok(await eye.evaluate((element) => element.classList.contains('idle')));
  await set(page, ['render.view.projection="perspective"']);
  await page.locator('[data-key="render.view.eye_distance_mm"]:not(.idle)').waitFor();
  await page.locator('.brief').filter({hasText: /Newest echo \d+ ms old, oldest \d+ ms; sticks lost: \d+/}).waitFor();
}));

test('probe and phantom are drawn in space, while that is open', () => withLive(async (page) => {
  const space = page.locator('.space');
  await page.getByText('Probe and phantom in space').click();
  await page.locator('.space[data-frame][data-drawn]').waitFor();
  const drawn = async () => Number(await space.getAttribute('data-drawn'));
  const first = await drawn();
  await page.waitForFunction((count) => Number(document.querySelector('.space').dataset.drawn) > count, first);
  const grid = Array.from({length: 900}, (_, i) => [(i % 30 + 0.5) / 30, (Math.floor(i / 30) + 0.5) / 30]);
  // Skin, and the blue face of the probe: the head may not be drawn yet on a busy machine.
  for (let tries = 0; ; ++tries) {
    const colours = await coloursAt(page, space.locator('canvas'), grid);
    const has = (test) => colours.filter(([r, g, b]) => test(r, g, b)).length;
    if (has((r, g, b) => r > 90 && r > g && g > b) > 20 && has((r, g, b) => b > 60 && b > 1.3 * r) > 2) break;
    assert.ok(tries < 20, JSON.stringify(colours));
    await page.waitForTimeout(500);
  }
  await space.locator('canvas').focus();
  await page.keyboard.press('ArrowLeft');
  await page.getByText('Probe and phantom in space').click();
  await page.waitForTimeout(100);
  const last = await drawn();
  const {volume} = await shownPixels(page);
  await volumeOf(page, Number(volume) + 3);
  assert.equal(await drawn(), last);
}));

test('warnings stand on the page', async () => {
  const other = await start(['--set', 'acquisition.frames_per_volume=1', '--gl', 'osmesa']);
  await withLive(async (page) => {
    const warnings = await page.locator('.warnings p').allTextContents();
    assert.deepEqual(warnings, [...new Set(other.warnings())].reverse());
    assert.ok(warnings.length > 0);
  }, {address: other.address});
  other.child.kill();
});

test('without a page the stream waits for one', async () => {
  const other = await start();
  while (!other.said().includes('no page is open')) await new Promise((resolve) => { setTimeout(resolve, 100); });
  await withLive(async (page) => {
    const {volume} = await shownPixels(page);
    await volumeOf(page, Number(volume) + 1);
  }, {address: other.address});
  other.child.kill();
});

test('everything is reached and used by the keyboard', () => withLive(async (page) => {
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();  // it has waited for a page
  const reached = [];
  for (let i = 0; i < 400; ++i) {
    await page.keyboard.press('Tab');
    const [name, hasMark] = await page.evaluate(() => {
      const element = document.activeElement;
      const {outlineStyle, boxShadow} = getComputedStyle(element);
      const marked = element.type === 'radio' ? getComputedStyle(element.nextSibling) : {outlineStyle, boxShadow};
      const label = element.labels?.[0]?.textContent;
      return [element === document.body ? '' : element.getAttribute('aria-label') ?? label ?? element.textContent,
        marked.outlineStyle !== 'none' || marked.boxShadow !== 'none'];
    });
    if (!name) break;
    assert.ok(hasMark, `${name}: not to be seen that it has the focus`);
    reached.push(name);
  }
  for (const name of ['Pause', 'One volume', 'Frame the head', 'Save scene', 'Compare with start', 'Picture', 'Drag turns', 'Volume of the last minute', 'Slow motion ¼',
    'drop', 'B-mode planes', 'Probe and phantom in space', 'Find a setting', 'Reset all', 'Yaw', 'Yaw, slider', 'Threshold']) {
    assert.ok(reached.some((each) => each === name || name === 'Picture' && each.startsWith('Picture')), `${name} of ${reached.join(' | ')}`);
  }
  assert.equal(await page.locator('button:visible, input:visible, select:visible, summary:visible, canvas[tabindex]:visible').count()
    - await page.locator('input[type="radio"]:visible:not(:checked)').count(), reached.length);
  await page.locator('.picture canvas').focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => document.querySelector('[data-key="render.view.yaw_deg"] input[type="text"]').value === '-5');
  await page.getByRole('button', {name: 'Pause'}).focus();
  await page.keyboard.press('Space');
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
  await page.keyboard.press('Enter');
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
}));

test('a page that is left open does not grow', () => withLive(async (page) => {
  const volumes = Number(process.env.PAGES_LIVE_VOLUMES ?? 150);
  await page.getByText('Error', {exact: true}).click();
  await page.getByText('B-mode planes').click();
  await page.getByText('Probe and phantom in space').click();
  const session = await page.context().newCDPSession(page);
  const use = async () => {
    await session.send('HeapProfiler.collectGarbage');
    const {usedSize} = await session.send('Runtime.getHeapUsage');
    const {nodes, jsEventListeners} = await session.send('Memory.getDOMCounters');
    return {usedSize, nodes, jsEventListeners};
  };
  const wait = async (count) => volumeOf(page, Number((await shownPixels(page)).volume) + count);
  // Time lines are full after 120 pictures.
  await wait(130);
  const before = await use();
  await wait(volumes);
  const after = await use();
  console.log(`${volumes} volumes: ${JSON.stringify(before)} to ${JSON.stringify(after)}`);
  assert.ok(after.usedSize < before.usedSize + 500_000, JSON.stringify([before, after]));
  assert.ok(after.nodes <= before.nodes + 20 && after.jsEventListeners <= before.jsEventListeners + 5, JSON.stringify([before, after]));
}));
