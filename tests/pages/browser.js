// What the tests of pages share: a browser, pages in it, and what went wrong on them. The environment names the
// packages (PAGES_PACKAGES), the browser (PAGES_BROWSER) and a folder for files (PAGES_SCRATCH).
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdirSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {homedir} from 'node:os';
import {basename, join} from 'node:path';
import {after, before} from 'node:test';

const {PAGES_PACKAGES, PAGES_BROWSER, PAGES_SCRATCH} = process.env;
const require = createRequire(join(PAGES_PACKAGES, 'package.json'));
const {chromium} = require('playwright-core');
const axeScript = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

export const desktop = {width: 1280, height: 900};
export const phone = {width: 390, height: 844};
export const patience_ms = Number(process.env.PAGES_PATIENCE_MS ?? 120_000);  // for machines with other work

// The suite's programs have a cache of their own; the browser keeps its fonts in the user's.
const usersEnvironment = {...process.env};
// Shaders stay the user's: compiled once, not for each suite.
process.env.MESA_SHADER_CACHE_DIR ??= join(homedir(), '.cache');
process.env.XDG_CACHE_HOME = scratch(join('cache', basename(process.argv[1], '_test.js')));

let browser;
before(async () => {
  // Chromium's own sandbox does not start as root, nor in most containers.
  browser = await chromium.launch({executablePath: PAGES_BROWSER, args: ['--no-sandbox'], timeout: patience_ms,
    env: usersEnvironment});
});
after(() => browser?.close());

/** An empty folder. */
export function scratch(name) {
  const folder = join(PAGES_SCRATCH, name);
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder, {recursive: true});
  return folder;
}

/** What a program prints, as lines. */
export function linesOf(program, args) {
  const {status, stdout, stderr, error} = spawnSync(program, args, {encoding: 'utf8'});
  assert.equal(status, 0, `${[program, ...args].join(' ')}\n${error ?? ''}${stderr}`);
  return stdout.trim().split('\n');
}

/** A page, and what it complained of or asked for besides addresses for which `isOwn(address)`. */
export async function newPage(isOwn, {viewport = desktop, colorScheme = 'light', javaScriptEnabled = true} = {}) {
  const context = await browser.newContext({viewport, colorScheme, javaScriptEnabled});
  const page = await context.newPage();
  page.setDefaultTimeout(patience_ms);
  const problems = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('request', (request) => {
    if (!/^(data|blob):/.test(request.url()) && !isOwn(request.url())) problems.push(request.url());
  });
  return {context, page, problems};
}

/** Opens a file, calls `use(page)`, and checks that nothing was complained of, loaded or run from the file's texts. */
export async function withPage(file, use, options = {}) {
  const {javaScriptEnabled = true} = options;
  const {context, page, problems} = await newPage((address) => address === `file://${file}`, options);
  try {
    await open(page, `file://${file}`);
    if (javaScriptEnabled) await drawn(page);
    await use(page);
    assert.deepEqual(problems, []);
    assert.equal(await page.locator('.problem').count(), 0);
    if (javaScriptEnabled) assert.equal(await page.evaluate(() => window.ran), undefined);
  } finally {
    await context.close();
  }
}

/** Opens an address, a second time where a busy machine has kept the browser's processes waiting. */
export async function open(page, url) {
  try {
    await page.goto(url);
  } catch (error) {
    if (error.name !== 'TimeoutError') throw error;
    await page.goto(url);
  }
}

/** Until each chart is drawn, and each map's values are there. */
async function drawn(page) {
  await page.waitForFunction(() =>
    [...document.querySelectorAll('.chart .panel')].every((panel) => panel.querySelector('svg'))
    && document.querySelectorAll('figure.map:not([data-ready])').length === 0);
}

/** Colours of an element on the screen, [red, green, blue] at shares of its width and height. */
export async function coloursAt(page, locator, shares) {
  await locator.scrollIntoViewIfNeeded();
  const picture = (await locator.screenshot({animations: 'disabled'})).toString('base64');
  return page.evaluate(async ({data, points}) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = Object.assign(document.createElement('canvas'), {width: image.width, height: image.height});
    const context = canvas.getContext('2d', {willReadFrequently: true});
    context.drawImage(image, 0, 0);
    return points.map(([x, y]) =>
      [...context.getImageData(Math.floor(x * image.width), Math.floor(y * image.height), 1, 1).data.slice(0, 3)]);
  }, {data: picture, points: shares});
}

/** What a map says of the pixel under the pointer. */
export async function readMap(page, map, column, row) {
  const canvas = map.locator('.stage canvas');
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const [width, height] = await canvas.evaluate((element) => [element.width, element.height]);
  await page.mouse.move(box.x + (column + 0.5) / width * box.width, box.y + (row + 0.5) / height * box.height);
  const reading = map.locator('.reading');
  const {column: atColumn, row: atRow, values} = await reading.evaluate((element) => ({...element.dataset}));
  assert.deepEqual([Number(atColumn), Number(atRow)], [column, row]);
  return {values: JSON.parse(values), text: await reading.textContent()};
}

/** Findings of axe-core that are serious or critical. */
export async function seriousFindings(page) {
  await page.evaluate(`${axeScript};0`);
  const {violations} = await page.evaluate(() => globalThis.axe.run({resultTypes: ['violations']}));
  return violations.filter(({impact}) => impact === 'serious' || impact === 'critical')
    .map(({id, nodes}) => `${id}: ${nodes.map(({html}) => html).slice(0, 3).join(' ')}`);
}

/** Accessibility, no sideways scrolling, and what `check(page)` sees. */
export function checkScreen(file, viewport, colorScheme, check = () => {}) {
  return withPage(file, async (page) => {
    assert.deepEqual(await seriousFindings(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
    await check(page);
  }, {viewport, colorScheme});
}

/** Both, on each kind of screen. */
export async function checkScreens(file) {
  for (const viewport of [desktop, phone]) {
    for (const colorScheme of ['light', 'dark']) await checkScreen(file, viewport, colorScheme);
  }
}
