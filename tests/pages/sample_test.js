// Each kind of block on a page of known values (sample_page.cpp).
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';

import {checkScreen, checkScreens, coloursAt, linesOf, newPage, phone, readMap, scratch, withPage} from './browser.js';

const folder = scratch('sample');
const sample = join(folder, 'sample.html');
const long = join(folder, 'long.html');
before(() => linesOf(process.env.PAGES_SAMPLE, [folder]));

const red = [255, 0, 0];
const blue = [0, 0, 255];

test('a page is accessible and fits every screen', () => checkScreens(sample));

test('so is one of ten thousand rows', () => checkScreen(long, phone, 'dark'));

test('the swipe shows left and right, and moves by pointer and by keyboard', () => withPage(sample, async (page) => {
  const pair = page.locator('.pair');
  assert.deepEqual(await coloursAt(page, pair, [[0.25, 0.5], [0.75, 0.5]]), [red, blue]);
  const box = await pair.boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, box.y + 40);
  await page.mouse.up();
  assert.deepEqual(await coloursAt(page, pair, [[0.75, 0.5], [0.85, 0.5]]), [red, blue]);
  await page.getByLabel('Share of the left picture').press('Home');
  assert.deepEqual(await coloursAt(page, pair, [[0.1, 0.5]]), [blue]);
}));

test('two pictures side by side, one through the other, and their difference', () => withPage(sample, async (page) => {
  const pair = page.locator('.pair');
  await page.getByText('Side by side').click();
  assert.deepEqual(await coloursAt(page, pair, [[0.2, 0.5], [0.8, 0.5]]), [red, blue]);
  await page.getByText('Difference').click();
  assert.deepEqual(await coloursAt(page, pair, [[0.5, 0.5]]), [[255, 0, 255]]);
  await page.getByText('Onion skin').click();
  const [[r, g, b]] = await coloursAt(page, pair, [[0.5, 0.5]]);
  assert.ok(Math.abs(r - 128) < 3 && g === 0 && Math.abs(b - 128) < 3, `${r} ${g} ${b}`);
}));

test('where a server forbids style, script and pictures, a line says so and names the files', async () => {
  const {context, page} = await newPage(() => true);
  await page.route('http://ci.invalid/**', (route) => route.fulfill({contentType: 'text/html', body: readFileSync(sample),
    headers: {'Content-Security-Policy': "sandbox; default-src 'none'; img-src 'self'; style-src 'self'"}}));
  await page.goto('http://ci.invalid/sample.html');
  assert.match(await page.locator('p.blocked').innerText(), /forbids its style/);
  const named = await page.locator('figure a.blocked:visible').allInnerTexts();
  assert.equal(named.length, await page.locator('figure img').count());
  assert.match(named[0], /\.png$/);
  await context.close();
});

test('a map says the value of each pixel under the pointer', () => withPage(sample, async (page) => {
  const map = page.locator('#m-error');
  for (let row = 0; row < 6; ++row) {
    for (let column = 0; column < 8; ++column) {
      const {values} = await readMap(page, map, column, row);
      if (column === 2 && row === 1) {
        assert.deepEqual(values, [null, null]);
      } else {
        const code = 100 * row + column;
        assert.ok(Math.abs(values[0] - (-2.5 + 0.01 * code)) < 1e-9 && values[1] === 50 + code, `${column} ${row}`);
      }
    }
  }
  assert.match((await readMap(page, map, 2, 1)).text, /column 2, row 1.*missed/);
  assert.match((await readMap(page, map, 0, 3)).text, /signed error 0\.500 mm, depth 350\.0 mm$/);
}));

test('a map is read by the arrow keys', () => withPage(sample, async (page) => {
  const canvas = page.locator('#m-error .stage canvas');
  const reading = page.locator('#m-error .reading');
  await canvas.focus();
  await canvas.press('ArrowLeft');
  await canvas.press('ArrowDown');
  assert.match(await reading.textContent(), /^column 3, row 4: /);
  await canvas.press('Shift+ArrowLeft');
  assert.match(await reading.textContent(), /^column 0, row 4: /);
}));

test('a map has the colours of its layer, and of classes that are not hidden', () => withPage(sample, async (page) => {
  const map = page.locator('#m-error');
  const canvas = map.locator('.stage canvas');
  const at = (column, row) => [(column + 0.5) / 8, (row + 0.5) / 6];
  // -2.5 mm is a dark blue, -2.5 + 5.05 mm a dark red.
  const [[lowRed, , lowBlue], [highRed, , highBlue], missed, false_] =
    await coloursAt(page, canvas, [at(0, 0), at(5, 5), at(2, 1), at(5, 4)]);
  assert.ok(lowBlue > 2 * lowRed && highRed > 2 * highBlue);
  assert.deepEqual([missed, false_], [[213, 94, 0], [0, 158, 115]]);
  await map.getByLabel('false surface').uncheck();
  const [value] = await coloursAt(page, canvas, [at(5, 4)]);
  assert.ok(value[0] > value[2], `${value}`);  // 1.55 mm: a red
  await map.getByText('depth', {exact: true}).click();
  const [[r, g, b]] = await coloursAt(page, canvas, [at(0, 0)]);
  assert.ok(b > g && g < 60 && r < 80, `${r} ${g} ${b}`);  // 50 of 0 to 600: viridis' violet
  assert.match(await map.locator('.colour-bar').textContent(), /depth, mm/);
}));

test('a click on a point shows its command, and marks its row', () => withPage(sample, async (page) => {
  const point = page.locator('#c-front svg .mark-symbol.role-mark path').nth(2);
  await point.scrollIntoViewIfNeeded();
  await point.hover();
  assert.match(await page.locator('.tooltip').textContent(), /<\/script><script>/);
  await point.click();
  const detail = page.locator('aside.detail');
  assert.equal(await detail.locator('pre.command').textContent(), 'wobblebench run --set x=2');
  assert.equal(await page.locator('tr[aria-current]').getAttribute('data-id'), 'point 2');
  await page.keyboard.press('Escape');
  assert.ok(await detail.isHidden());
  assert.equal(await page.locator('tr[aria-current]').count(), 0);
}));

test('a row is chosen by the keyboard, and shows its picture', () => withPage(sample, async (page) => {
  await page.locator('#t-points tbody tr').first().focus();
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  const detail = page.locator('aside.detail');
  assert.equal(await detail.locator('pre.command').textContent(), 'wobblebench run --set x=3');
  assert.equal(await detail.locator('img').evaluate((image) => image.naturalWidth), 200);
  assert.equal(await page.locator('#c-front svg .chosen').count(), 1);
  await page.keyboard.press('Escape');
  assert.equal(await page.evaluate(() => document.activeElement.dataset.id), 'point 3');
}));

test('a column sorts up, down and back, with empty cells last', () => withPage(sample, async (page) => {
  const heading = page.locator('#t-points th').nth(2);
  const ids = () => page.locator('#t-points tbody tr').evaluateAll((rows) => rows.map((row) => row.dataset.id));
  const inOrder = await ids();
  const others = inOrder.filter((id) => id !== 'point 4');
  await heading.getByRole('button').click();
  assert.equal(await heading.getAttribute('aria-sort'), 'ascending');
  assert.deepEqual(await ids(), [...others].reverse().concat('point 4'));
  await heading.getByRole('button').press('Enter');
  assert.equal(await heading.getAttribute('aria-sort'), 'descending');
  assert.deepEqual(await ids(), [...others, 'point 4']);
  await heading.getByRole('button').click();
  assert.deepEqual(await ids(), inOrder);
}));

test('ten thousand rows are sorted, searched and shown', () => withPage(long, async (page) => {
  const table = page.locator('#t-long');
  const rows = table.locator('tbody tr');
  assert.equal(await rows.count(), 500);
  await table.locator('th').nth(1).getByRole('button').click();
  assert.match(await rows.first().textContent(), /row 0/);
  // 7919 * 7679 = 1 mod 10000.
  assert.match(await rows.nth(1).textContent(), /row 7679/);
  await table.getByLabel('Search rows').fill('row 9999');
  assert.equal(await rows.count(), 1);
  await table.getByLabel('Search rows').fill('');
  await table.getByRole('button', {name: 'Show all'}).click();
  assert.equal(await rows.count(), 10000);
}));

test('markup in names is shown as text', () => withPage(sample, async (page) => {
  const markup = '<img src=x onerror="window.ran=1">';
  assert.equal(await page.locator('h1').textContent(), `Sample ${markup}`);
  assert.equal(await page.locator('#t-points tbody tr').nth(3).locator('td').first().textContent(), markup);
  assert.ok((await page.locator('#c-front svg').textContent()).includes('settings <img src='));  // a long name is cut
  await page.getByText('Scene <img').click();
  assert.equal(await page.locator('details.listing pre').first().textContent(), '</script><script>window.ran=1</script>');
}));

test('a figure of one point, and one of none, are drawn', () => withPage(sample, async (page) => {
  assert.equal(await page.locator('#c-one svg .mark-symbol.role-mark path').count(), 1);
  assert.match(await page.locator('#c-none').textContent(), /nothing to show/);
}));

test('a chart fits a phone', () => withPage(sample, async (page) => {
  const [svg, panel] = await Promise.all(['#c-front svg', '#c-front .panel'].map((name) => page.locator(name).boundingBox()));
  assert.ok(svg.width <= panel.width && svg.width > 0.9 * panel.width);
}, {viewport: phone}));

test('on paper, pictures stand side by side and controls are gone', () => withPage(sample, async (page) => {
  await page.emulateMedia({media: 'print'});
  assert.deepEqual(await coloursAt(page, page.locator('.pair'), [[0.2, 0.5], [0.8, 0.5]]), [red, blue]);
  assert.ok(await page.locator('.comparison .choice').isHidden());
}));

test('without its script, a page has its texts, tables and pictures', () => withPage(sample, async (page) => {
  assert.equal(await page.locator('#t-points tbody tr').count(), 12);
  assert.ok(await page.getByAltText('Red').isVisible());
  assert.equal(await page.getByText('strong', {exact: true}).evaluate((element) => element.tagName), 'STRONG');
}, {javaScriptEnabled: false}));

test('without its script, all ten thousand rows are there', () => withPage(long, async (page) => {
  assert.equal(await page.locator('#t-long tbody tr').count(), 10000);
}, {javaScriptEnabled: false}));
