// The live page: its pictures are those of `run`, and its server answers nobody but its own pages.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {randomBytes} from 'node:crypto';
import {once} from 'node:events';
import {readFileSync, writeFileSync} from 'node:fs';
import {request} from 'node:http';
import {join} from 'node:path';
import {after, test} from 'node:test';

import {coloursAt, desktop, linesOf, newPage, open, phone, scratch, seriousFindings} from './browser.js';

const folder = scratch('live');
const sceneFile = join(folder, 'scene.toml');
writeFileSync(sceneFile, `phantom = { name = "sphere", voxel_mm = 2 }
acquisition = { frames_per_volume = 17, sticks_per_frame = 32 }
simulation.fidelity = "geometry"
render.scan_conversion.slice_size = 64
render.ray_casting.image_size = 64
`);
const program = process.env.PAGES_PROGRAM;
const started = [];

/** `wobblebench live`, and the address that it prints. */
async function start(args = [], port = '0') {
  const child = spawn(program, ['live', sceneFile, '--port', port, ...args], {stdio: ['ignore', 'pipe', 'pipe']});
  started.push(child);
  let said = '', complained = '';
  child.stdout.on('data', (data) => { said += data; });
  child.stderr.on('data', (data) => { complained += data; });
  const [line] = await Promise.race([once(child.stdout, 'data'), once(child, 'exit')]);
  const warnings = () => [...complained.matchAll(/^wobblebench: warning: (.*)$/gm)].map(([, text]) => text);
  return {child, address: String(line).split('\n')[0], said: () => said, warnings};
}
after(() => { for (const child of started) child.kill('SIGKILL'); });
const live = await start();

/** A drawing of WebGL is read by a screenshot, of whose cost chromium tells. */
const ofScreenshots = /GPU stall due to ReadPixels/;

async function withLive(use, {address = live.address, ...options} = {}) {
  const {origin} = new URL(address);
  const isOwn = (url) => url.startsWith(origin) || url.startsWith(origin.replace('http', 'ws'));
  const {context, page, problems} = await newPage(isOwn, options);
  try {
    await open(page, address);
    await pictureOf(page);
    await use(page);
    assert.deepEqual(problems.filter((problem) => !ofScreenshots.test(problem)), []);
  } finally {
    if (address.startsWith(live.address)) {
      await ask(page, {do: 'reset', keys: []});
      await ask(page, {do: 'play'});
    }
    await context.close();
  }
}

/** Until the page shows a picture of this state or a later one. */
function pictureOf(page, serial = 0) {
  return page.waitForFunction((least) => Number(document.querySelector('.picture canvas')?.dataset.serial ?? -1) >= least, serial);
}

/** The answer to a request, over a connection of its own. */
function ask(page, message) {
  return page.evaluate((asked) => new Promise((resolve) => {
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/socket${location.search}`);
    socket.onopen = () => socket.send(JSON.stringify({...asked, id: 1}));
    socket.onmessage = ({data}) => {
      if (typeof data !== 'string') return;
      const answer = JSON.parse(data);
      if (answer.id !== 1) return;
      socket.close();
      resolve(answer);
    };
  }), message);
}

async function set(page, settings) {
  const answer = await ask(page, {do: 'set', settings});
  assert.equal(answer.type, 'done', answer.why);
  return answer.serial;
}

/** The saved scene of a picture of this state or a later one. */
async function savedOf(page, serial) {
  for (;;) {
    const saved = await ask(page, {do: 'save'});
    if (saved.serial >= serial) return saved;
    await page.waitForTimeout(50);
  }
}

/** Whether `run` makes the picture of a saved scene, byte for byte. */
function checkSaved(saved, name) {
  assert.equal(saved.why_not_the_same, '');
  const file = join(folder, `${name}.toml`);
  const out = scratch(join('live', name));
  writeFileSync(file, saved.toml);
  const words = saved.command.split(' ').slice(1).map((word) => word === 'scene.toml' ? file : word);
  linesOf(program, [...words, '--out', out]);
  const isSame = readFileSync(join(out, 'surface.png')).equals(Buffer.from(saved.picture, 'base64'));
  assert.ok(isSame, `${saved.command}\n${saved.toml}`);
}

/** The status of the answer to a request with these headers. */
async function statusOf(address, headers, path) {
  const {port, search} = new URL(address);
  const asked = request({host: '127.0.0.1', port, path: path ?? `/${search}`, headers});
  asked.end();
  const [answer] = await Promise.race([once(asked, 'response'), once(asked, 'upgrade')]);
  answer.destroy();
  return answer.statusCode;
}

const upgrade = {Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': '13', 'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ=='};

test('a slider moves, and the picture becomes that of run with this setting', () => withLive(async (page) => {
  const control = page.locator('[data-key="render.shading.light_left_deg"]');
  await control.locator('input[type="range"]').focus();
  for (let i = 0; i < 20; ++i) await page.keyboard.press('ArrowRight');
  const value = await control.locator('input[type="text"]').inputValue();
  assert.ok(Number(value) > 0, value);
  await page.waitForFunction(() => !document.querySelector('[data-key="render.shading.light_left_deg"] .reset').hidden);
  const saved = await savedOf(page, await set(page, [`render.shading.light_left_deg=${value}`]));
  checkSaved(saved, 'slider');
  // The page shows that picture, too, but for the loss of JPEG.
  await pictureOf(page, saved.serial);
  const [difference, contrast] = await page.evaluate(async (picture) => {
    const image = new Image();
    image.src = `data:image/png;base64,${picture}`;
    await image.decode();
    const canvas = document.querySelector('.picture canvas');
    const other = Object.assign(document.createElement('canvas'), {width: canvas.width, height: canvas.height});
    other.getContext('2d').drawImage(image, 0, 0);
    const [one, two] = [canvas, other].map((each) => each.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data);
    const mean = one.reduce((sum, number) => sum + number, 0) / one.length;
    return [one.reduce((sum, number, index) => sum + Math.abs(number - two[index]), 0) / one.length,
      one.reduce((sum, number) => sum + Math.abs(number - mean), 0) / one.length];
  }, saved.picture);
  assert.ok(difference < 3 && contrast > 20, `${difference} of ${contrast}`);
}));

test('random states are saved as scenes that make the same picture', () => withLive(async (page) => {
  // The minimal standard generator (Park and Miller, 1988).
  let seed = Number(process.env.PAGES_LIVE_SEED ?? 42);
  const random = (low, high) => {
    seed = seed * 48271 % 2147483647;
    return Number((low + (high - low) * seed / 2147483647).toPrecision(4));
  };
  const pick = (...names) => names[Math.floor(random(0, names.length - 1e-3))];
  // Faces of one size, which are built once.
  const face = () => ['phantom.name="fetal_face"', 'phantom.voxel_mm=1.5', 'phantom.mouth_open_mm=6', `simulation.fidelity="${pick('geometry', 'field')}"`,
    `motion.velocity_mm_s=[${random(-9, 9)}, ${random(-9, 9)}, ${random(-9, 9)}]`, `motion.breath_amplitude_mm=${random(0, 4)}`,
    `motion.head_turn_deg=${random(0, 20)}`, `motion.mouth_close_mm=${random(0, 6)}`];
  const sphere = () => ['phantom.name="sphere"', 'phantom.voxel_mm=2', `phantom.radius_mm=${random(15, 40)}`,
    `simulation.fidelity="${pick('geometry', 'field', 'scatterers')}"`, `simulation.seed=${Math.floor(random(1, 1000))}`,
    `acquisition.motor="${pick('stepped', 'continuous', 'alternating')}"`, `simulation.noise_db=${random(-60, -20)}`];
  for (let i = 0; i < Number(process.env.PAGES_LIVE_STATES ?? 3); ++i) {
    if (i > 0) {
      await ask(page, {do: 'reset', keys: []});
      await set(page, i % 2 === 1 ? face() : sphere());
    }
    const serial = await set(page, [`render.view.yaw_deg=${random(-180, 180)}`, `render.view.pitch_deg=${random(-60, 60)}`,
      `render.view.projection=${pick('parallel', 'perspective')}`, `render.view.flip=${pick('true', 'false')}`,
      `render.ray_casting.detector=${pick('paper', 'iso', 'floor')}`, `render.ray_casting.iso_level=${random(0.3, 0.9)}`,
      `render.ray_casting.threshold=${random(0.05, 0.5)}`, `render.ray_casting.kernel_3d=${pick(1, 3, 5)}`,
      `render.shading.light_up_deg=${random(-80, 80)}`, `render.shading.ambient=${random(0, 0.5)}`,
      `render.smoothing.filter=${pick('box', 'bilateral', 'guided')}`, `render.pipeline.mode=${pick('fast', 'plain')}`,
      `render.reconstruction.sticks=${pick('plain', 'aligned')}`]);
    checkSaved(await savedOf(page, serial), `state_${i}`);
    assert.equal(await page.locator('#why:not([hidden])').count(), 0, await page.locator('#why').textContent());
    console.log(`state ${i}: ${JSON.stringify(await page.evaluate(() => decodeURIComponent(location.hash)))}`);
  }
}));

test('a setting out of range is refused with the line of the command line', () => withLive(async (page) => {
  const control = page.locator('[data-key="render.ray_casting.iso_level"]');
  await control.locator('input[type="text"]').fill('9');
  await control.locator('input[type="text"]').press('Enter');
  const said = await control.locator('.problem:not([hidden])').textContent();
  const {status, stderr} = spawnSync(program, ['run', sceneFile, '--set', 'render.ray_casting.iso_level=9'], {encoding: 'utf8'});
  assert.equal(status, 2);
  assert.equal(`wobblebench: ${said}\n`, stderr);
}));

test('dragging turns the head, with Shift moves the light', () => withLive(async (page) => {
  const box = await page.locator('.picture canvas').boundingBox();
  const drag = async (right, down) => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + right, box.y + box.height / 2 + down, {steps: 4});
    await page.mouse.up();
  };
  const becomes = (key, expected) => page.waitForFunction(([of, value]) =>
    Math.abs(Number(document.querySelector(`[data-key="${of}"] input[type="text"]`).value) - value) < 1, [key, expected]);
  await drag(box.width / 6, box.width / 9);
  await becomes('render.view.yaw_deg', -30);
  await becomes('render.view.pitch_deg', 20);
  await page.keyboard.down('Shift');
  await drag(box.width / 6, 0);
  await page.keyboard.up('Shift');
  await becomes('render.shading.light_left_deg', -30);
  await page.getByRole('button', {name: 'Reset all'}).click();
  await becomes('render.view.yaw_deg', 0);
}));

test('the error of each pixel is found less true depth', () => withLive(async (page) => {
  await page.getByText('Error', {exact: true}).click();
  await page.locator('.legend .figures').filter({hasText: 'P95'}).waitFor();
  await page.locator('.picture canvas').hover();
  const text = await page.locator('.reading').filter({hasText: 'error'}).textContent();
  const [found, truth, error] = [...text.matchAll(/(−?[\d.]+) mm/g)].map(([, number]) => Number(number.replace('−', '-')));
  assert.ok(Math.abs(found - truth - error) < 0.011, text);
  assert.ok(found > 1 && Math.abs(error) < 5, text);
}));

/** Of the pixels that the page shows. */
function shownPixels(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector('.picture canvas');
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const {data} = copy.getImageData(0, 0, canvas.width, canvas.height);
    return {volume: canvas.dataset.volume, hash: data.reduce((hash, byte) => (hash * 31 + byte) % 2147483647, 7)};
  });
}

function volumeOf(page, least) {
  return page.waitForFunction((volume) => Number(document.querySelector('.picture canvas')?.dataset.volume ?? -1) >= volume, least);
}

test('going back shows a volume, its picture, error and planes as they were', () => withLive(async (page) => {
  // Else one volume is as the other.
  await pictureOf(page, await set(page, ['motion.velocity_mm_s=[20, 0, 0]']));
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
  await page.getByRole('button', {name: 'Pause'}).click();
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
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

test('the picture is compared with that of the start, of the same volume', () => withLive(async (page) => {
  await page.getByRole('button', {name: 'Pause'}).click();
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
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

test('a link carries what is set, through the checks of the command line', async () => {
  await withLive(async (page) => {
    await page.waitForFunction(() => location.hash.includes('render.view.roll_deg=17'));
    const values = await page.evaluate(() => ['render.view.roll_deg', 'render.shading.ambient']
      .map((key) => document.querySelector(`[data-key="${key}"] input[type="text"]`).value));
    assert.deepEqual(values, ['17', '0.3']);
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
  const {stderr} = spawnSync(program, ['rehearse', '--first-seed', '4', '--seeds', '1', '--trace', '--out', scratch(join('live', 'rehearsal'))],
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

test('probe and phantom are drawn in space, while that is open', () => withLive(async (page) => {
  const space = page.locator('.space');
  await page.getByText('Probe and phantom in space').click();
  await page.locator('.space[data-frame][data-drawn]').waitFor();
  const drawn = async () => Number(await space.getAttribute('data-drawn'));
  const first = await drawn();
  await page.waitForFunction((count) => Number(document.querySelector('.space').dataset.drawn) > count, first);
  const colours = await coloursAt(page, space.locator('canvas'), Array.from({length: 900}, (_, i) => [(i % 30 + 0.5) / 30, (Math.floor(i / 30) + 0.5) / 30]));
  const has = (test) => colours.filter(([r, g, b]) => test(r, g, b)).length;
  // Skin, and the blue face of the probe.
  assert.ok(has((r, g, b) => r > 90 && r > g && g > b) > 20 && has((r, g, b) => b > 60 && b > 1.3 * r) > 2, JSON.stringify(colours.slice(400, 500)));
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
  const other = await start(['--set', 'acquisition.depth_mm=80', '--gl', 'osmesa']);
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
  for (const name of ['Pause', 'One volume', 'Save scene', 'Compare with start', 'Picture', 'Drag turns', 'Volume of the last minute', 'Slow motion ¼',
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

test('planes, faults, pause and one volume do what they say', () => withLive(async (page) => {
  await page.getByText('B-mode planes').click();
  await page.locator('.planes[data-ready]').waitFor();
  await page.getByRole('button', {name: 'drop', exact: true}).click();
  await page.locator('.times .account').filter({hasText: /lost \d+/}).waitFor();
  await page.getByRole('button', {name: 'drop', exact: true}).click();
  await page.getByRole('button', {name: 'Pause'}).click();
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
  const before = (await ask(page, {do: 'save'})).volume;
  await page.getByRole('button', {name: 'One volume'}).click();
  await page.waitForFunction((volume) => Number(document.querySelector('.picture canvas').dataset.volume) === volume + 1, before);
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
  assert.equal((await ask(page, {do: 'save'})).volume, before + 1);
  await page.getByRole('button', {name: 'Play'}).click();
  await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
}));

test('two viewers see the same state, beside one that reads nothing', () => withLive(async (page) => {
  const silent = request({host: '127.0.0.1', port: new URL(live.address).port, path: '/socket',
    headers: {...upgrade, Origin: new URL(live.address).origin}});
  silent.end();
  const [, socket] = await once(silent, 'upgrade');
  socket.pause();
  await withLive(async (other) => {
    const serial = await set(page, ['render.view.roll_deg=12']);
    await Promise.all([pictureOf(page, serial), pictureOf(other, serial)]);
    for (const each of [page, other]) {
      assert.equal(await each.locator('[data-key="render.view.roll_deg"] input[type="text"]').inputValue(), '12');
    }
  });
  socket.destroy();
}));

test('a page finds the program again', async () => {
  const first = await start();
  const {port} = new URL(first.address);
  const {context, page} = await newPage(() => true);
  await open(page, first.address);
  await pictureOf(page);
  first.child.kill('SIGINT');
  const [code] = await once(first.child, 'exit');
  assert.equal(code, 0);
  await page.locator('body.offline').waitFor();
  const second = await start([], port);
  await page.locator('body:not(.offline)').waitFor();
  const serial = await set(page, ['render.view.roll_deg=30']);
  await pictureOf(page, serial);
  await context.close();
  second.child.kill();
});

test('1 000 malformed messages are refused one by one', () => withLive(async (page) => {
  const texts = ['', '{', '[]', 'null', '{"do": 3}', '{"do": "fly"}', '{"do": "set"}', '{"do": "set", "settings": "a"}',
    '{"do": "set", "settings": [1]}', '{"do": "set", "settings": ["phantom.file=/etc/passwd"]}',
    '{"do": "set", "settings": ["render.correction=/etc/passwd"]}', '{"do": "set", "settings": ["render.program=sh"]}',
    '{"do": "set", "settings": ["render.view.yaw_deg=[[[[[[1"]}', '{"do": "faults", "faults": "drop:7"}', '['.repeat(60000),
    ...Array.from({length: 85}, () => randomBytes(40).toString('latin1'))];
  const answers = await page.evaluate(async (messages) => {
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/socket`);
    await new Promise((resolve) => { socket.onopen = resolve; });
    const types = [];
    for (let i = 0; i < 1000; ++i) {
      const answer = new Promise((resolve) => {
        socket.onmessage = ({data}) => typeof data === 'string' && 'id' in JSON.parse(data) && resolve(JSON.parse(data).type);
      });
      socket.send(messages[i % messages.length]);
      types.push(await answer);
    }
    socket.close();
    return types;
  }, texts);
  assert.deepEqual([answers.length, new Set(answers)], [1000, new Set(['refused'])]);
  await pictureOf(page, await set(page, ['render.view.roll_deg=0']));
}));

test('other sites, names and methods are refused', async () => {
  const {host, origin, port} = new URL(live.address);
  const socket = (headers) => statusOf(live.address, {...upgrade, ...headers}, '/socket');
  assert.equal(await statusOf(live.address, {}), 200);
  assert.equal(await statusOf(live.address, {Host: `localhost:${port}`}), 200);
  assert.equal(await statusOf(live.address, {Host: `evil.example:${port}`}), 403);
  assert.equal(await statusOf(live.address, {Origin: 'http://evil.example'}), 403);
  assert.equal(await statusOf(live.address, {}, '/../../etc/passwd'), 404);
  assert.equal(await socket({Host: host, Origin: origin}), 101);
  assert.equal(await socket({Host: host}), 403);
  assert.equal(await socket({Host: host, Origin: 'http://evil.example'}), 403);
  assert.equal(await socket({Host: `evil.example:${port}`, Origin: `http://evil.example:${port}`}), 403);
});

test('with --listen nobody comes in without the token', async () => {
  const other = await start(['--listen', '127.0.0.1']);
  const {host, origin, search} = new URL(other.address);
  assert.match(search, /^\?token=[0-9a-f]{32}$/);
  const socket = (query) => statusOf(other.address, {...upgrade, Host: host, Origin: origin}, `/socket${query}`);
  assert.equal(await statusOf(other.address, {}, '/'), 403);
  assert.equal(await statusOf(other.address, {}, '/?token=0'), 403);
  assert.equal(await socket(''), 403);
  assert.equal(await socket(search), 101);
  await withLive((page) => pictureOf(page), {address: other.address});
  other.child.kill();
});

for (const [name, viewport] of [['desktop', desktop], ['phone', phone]]) {
  for (const colorScheme of ['light', 'dark']) {
    test(`the page is accessible and fits a ${name}, ${colorScheme}`, () => withLive(async (page) => {
      assert.deepEqual(await seriousFindings(page), []);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
      await page.screenshot({path: join(folder, `${name}_${colorScheme}.png`), fullPage: true});
    }, {viewport, colorScheme}));
  }
}

test('a recording ends, and is played again', async () => {
  const record = scratch(join('live', 'recording'));
  linesOf(program, ['record', sceneFile, '--set', 'acquisition.volumes=3', '--out', record]);
  const other = await start(['--board', `file=${join(record, 'recording.wbst')}`]);
  await withLive(async (page) => {
    const ended = page.locator('#stage').filter({hasText: 'ended'});
    await ended.waitFor();
    assert.equal(await page.locator('[data-section="phantom"]').count(), 0);
    await page.getByRole('button', {name: 'Play'}).click();
    await page.locator('#stage').filter({hasText: 'Playing'}).or(ended).waitFor();
    await ended.waitFor();
    const saved = await ask(page, {do: 'save'});
    assert.equal(saved.volume, 2);
    assert.match(saved.why_not_the_same, /first volume/);
  }, {address: other.address});
  other.child.kill();
});
