// What the tests of the live page share: the program, pages on it, and what they ask of it.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {readFileSync, writeFileSync} from 'node:fs';
import {basename, join} from 'node:path';
import {after} from 'node:test';

import {linesOf, newPage, open, patience_ms, scratch} from './browser.js';

/** Of this suite. */
const suite = basename(process.argv[1], '_test.js');
export const folder = scratch(suite);
/** A folder in it. */
export const within = (name) => scratch(join(suite, name));
export const sceneFile = join(folder, 'scene.toml');
writeFileSync(sceneFile, `phantom = { name = "sphere", voxel_mm = 2 }
acquisition = { frames_per_volume = 17, sticks_per_frame = 32 }
simulation.fidelity = "geometry"
render.scan_conversion.slice_size = 64
render.ray_casting.image_size = 64
`);
export const program = process.env.PAGES_PROGRAM;
const started = [];

/** `wobblebench live`, and the address that it prints. */
export async function start(args = [], port = '0') {
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
export const live = await start();

/** A drawing of WebGL is read by a screenshot, of whose cost chromium tells. */
const ofScreenshots = /GPU stall due to ReadPixels/;

export async function withLive(use, {address = live.address, ...options} = {}) {
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
export function pictureOf(page, serial = 0) {
  return page.waitForFunction((least) => Number(document.querySelector('.picture canvas')?.dataset.serial ?? -1) >= least, serial);
}

/** The answer to a request, over a connection of its own. */
export function ask(page, message) {
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

export async function set(page, settings) {
  const answer = await ask(page, {do: 'set', settings});
  assert.equal(answer.type, 'done', answer.why);
  return answer.serial;
}

/** The saved scene of a picture of this state or a later one. */
export async function savedOf(page, serial) {
  for (const end = Date.now() + patience_ms; Date.now() < end;) {
    const saved = await ask(page, {do: 'save'});
    if (saved.serial >= serial) return saved;
    await page.waitForTimeout(50);
  }
  throw new Error(`no picture of state ${serial}`);
}

/** Whether `run` makes the picture of a saved scene, byte for byte. */
export function checkSaved(saved, name) {
  assert.equal(saved.why_not_the_same, '');
  const file = join(folder, `${name}.toml`);
  const out = within(name);
  writeFileSync(file, saved.toml);
  const words = saved.command.split(' ').slice(1).map((word) => word === 'scene.toml' ? file : word);
  linesOf(program, [...words, '--out', out]);
  const isSame = readFileSync(join(out, 'surface.png')).equals(Buffer.from(saved.picture, 'base64'));
  assert.ok(isSame, `${saved.command}\n${saved.toml}`);
}

/** Of the pixels that the page shows. */
export function shownPixels(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector('.picture canvas');
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const {data} = copy.getImageData(0, 0, canvas.width, canvas.height);
    return {volume: canvas.dataset.volume, hash: data.reduce((hash, byte) => (hash * 31 + byte) % 2147483647, 7)};
  });
}

/** Stops the stream, and waits for its last picture, which may come after the word that it has stopped. */
export async function pause(page) {
  await page.getByRole('button', {name: 'Pause'}).click();
  await page.locator('#stage').filter({hasText: 'Paused'}).waitFor();
  await volumeOf(page, (await ask(page, {do: 'save'})).volume);
}

export function volumeOf(page, least) {
  return page.waitForFunction((volume) => Number(document.querySelector('.picture canvas')?.dataset.volume ?? -1) >= volume, least);
}
