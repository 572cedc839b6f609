// The live page: its pictures are those of `run`, and its server answers nobody but its own pages.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {randomBytes} from 'node:crypto';
import {once} from 'node:events';
import {request} from 'node:http';
import {join} from 'node:path';
import {test} from 'node:test';

import {desktop, linesOf, newPage, open, patience_ms, phone, seriousFindings} from './browser.js';
import {ask, checkSaved, folder, live, pause, pictureOf, program, savedOf, sceneFile, set, start, within, withLive} from './live_program.js';

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
    `motion.head_turn_deg=${random(0, 20)}`, `motion.mouth_close_mm=${random(0, 5)}`];
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

test('a scan that is asked for while another one is prepared is played', () => withLive(async (page) => {
  for (let i = 0; i < 12; ++i) {
    await set(page, [`phantom.radius_mm=${20 + i}`]);
    await page.waitForTimeout(15 * i);
    const radius = `phantom.radius_mm=${20.5 + i}`;
    const saved = await savedOf(page, await set(page, [radius]));
    assert.match(saved.toml, new RegExp(`radius_mm = ${20.5 + i}`));
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

test('planes, faults, pause and one volume do what they say', () => withLive(async (page) => {
  await page.getByText('B-mode planes').click();
  await page.locator('.planes[data-ready]').waitFor();
  await page.getByRole('button', {name: 'drop', exact: true}).click();
  await page.locator('.times .account').filter({hasText: /lost \d+/}).waitFor();
  await page.getByRole('button', {name: 'drop', exact: true}).click();
  await pause(page);
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
    '{"do": "set", "settings": ["render.program=sh"]}',
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
  assert.equal(await statusOf(live.address, {Host: `LOCALHOST:${port}`}), 200);
  assert.equal(await statusOf(live.address, {Host: `evil.example:${port}`}), 403);
  assert.equal(await statusOf(live.address, {Origin: 'http://evil.example'}), 403);
  assert.equal(await statusOf(live.address, {}, '/../../etc/passwd'), 404);
  assert.equal(await socket({Host: host, Origin: origin}), 101);
  assert.equal(await socket({Host: host}), 403);
  assert.equal(await socket({Host: host, Origin: 'http://evil.example'}), 403);
  assert.equal(await socket({Host: `evil.example:${port}`, Origin: `http://evil.example:${port}`}), 403);
  // A tunnel to another port, and the page of another server on this machine.
  assert.equal(await socket({Host: 'localhost:9000', Origin: 'http://localhost:9000'}), 101);
  assert.equal(await socket({Host: host, Origin: 'http://127.0.0.1:9000'}), 403);
});

test('behind a proxy the token opens the page, and --name the socket', async () => {
  const other = await start(['--name', 'Bench.example.org']);
  const {host, search} = new URL(other.address);
  const socket = (Host, Origin, query = search) => statusOf(other.address, {...upgrade, Host, Origin}, `/socket${query}`);
  assert.equal(other.said().split('\n')[1], `bench.example.org/${search}`);
  assert.equal(await statusOf(other.address, {Host: 'bench.example.org'}, `/${search}`), 200);
  assert.equal(await statusOf(other.address, {Host: 'bench.example.org'}, '/'), 403);
  assert.equal(await socket('bench.example.org', 'https://bench.example.org'), 101);
  assert.equal(await socket(host, 'https://bench.example.org'), 101);
  assert.equal(await socket('lab-pc', 'http://lab-pc:8642'), 101);
  assert.equal(await socket(host, 'https://bench.example.org', ''), 403);
  assert.equal(await socket(host, 'https://evil.example'), 403);
  other.child.kill();
});

test('the page notices that the program is silent, and goes on with it', async () => {
  const other = await start();
  await withLive(async (page) => {
    other.child.kill('SIGSTOP');
    await page.locator('#stage').filter({hasText: 'does not answer'}).waitFor();
    other.child.kill('SIGCONT');
    await page.locator('#stage').filter({hasText: 'Playing'}).waitFor();
    await pictureOf(page, await set(page, ['render.view.roll_deg=3']));
  }, {address: other.address});
  other.child.kill();
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
  const record = within('recording');
  linesOf(program, ['record', sceneFile, '--set', 'acquisition.volumes=3', '--out', record]);
  const other = await start(['--board', `file=${join(record, 'recording.wbst')}`]);
  await withLive(async (page) => {
    const ended = page.locator('#stage').filter({hasText: 'ended'});
    // After Play the page may still show the end of the stream before: the picture of its last volume is a later one.
    const endAfter = async (earlier) => {
      for (const end = Date.now() + patience_ms; Date.now() < end; await page.waitForTimeout(50)) {
        const {number, volume} = (await ask(page, {do: 'history'})).volumes.at(-1) ?? {};
        if (volume !== 2 || number <= earlier) continue;
        await ended.waitFor();
        return number;
      }
      throw new Error(`the last volume was not shown after picture ${earlier}`);
    };
    const first = await endAfter(-1);
    assert.equal(await page.locator('[data-section="phantom"]').count(), 0);
    await page.getByRole('button', {name: 'Play'}).click();
    await endAfter(first);
    const saved = await ask(page, {do: 'save'});
    assert.equal(saved.volume, 2);
    assert.match(saved.why_not_the_same, /first volume/);
  }, {address: other.address});
  other.child.kill();
});
