// The curve view against `retalho curve --json` on the document that the page saves.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {retalho, View} from './support.mjs';

async function withPage(run) {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-curves-'));
  const view = await View.open([]);
  try {
    await view.go();
    await run({view, page: view.page, folder});
    // The browser logs a call that the program refused; the page says why in words, which the tests read.
    assert.deepEqual(view.problems.filter((words) => !/400 \(Bad Request\)/.test(words)), [], 'the browser reports no error');
  } finally {
    assert.equal(await view.close(), 0);
    rmSync(folder, {recursive: true});
  }
}

async function saved(page, folder) {
  const saving = page.waitForEvent('download');
  await page.getByRole('button', {name: 'Save curves'}).click();
  const file = join(folder, 'curves.json');
  await (await saving).saveAs(file);
  return file;
}

const joinsShown = (page) => page.$$eval('.joins tbody tr', (rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
const lengthShown = (page) => page.$eval('.controls:not([hidden]) .readout', (box) => Number([...box.querySelectorAll('dt')].find((dt) => dt.textContent === 'length').nextElementSibling.textContent));

async function example(view, name) {
  await view.page.locator('.controls:not([hidden])').getByLabel('Example').selectOption({label: name});
  await view.quiet();
}

export const tests = [
  ['a dragged control point: the page says what the program says of the saved file', () => withPage(async ({view, page, folder}) => {
    await view.picture('start');
    await page.getByRole('button', {name: /triangle/}).click();
    await view.quiet();
    const before = await lengthShown(page);
    const point = page.locator('circle.point').nth(1);
    const box = await point.boundingBox();
    const x = box.x + box.width / 2, y = box.y + box.height / 2;
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y + 25, {steps: 4});
    await page.mouse.move(x + 70, y + 60, {steps: 4});
    await page.mouse.up();
    await view.quiet();
    const moved = await point.boundingBox();
    assert.ok(Math.abs(moved.x - box.x - 70) < 1.5 && Math.abs(moved.y - box.y - 60) < 1.5, 'the point lies under the pointer');
    const after = await lengthShown(page);
    assert.notEqual(after, before);
    const [curve] = retalho('curve', await saved(page, folder)).curves;
    assert.ok(Math.abs(after - curve.length) < 1e-6 * curve.length, `${after} against ${curve.length}`);
    await view.picture('curves-casteljau');
    await page.keyboard.press('Control+z');
    await view.quiet();
    assert.ok(Math.abs(await lengthShown(page) - before) < 1e-9, 'one step of undo for one drag');
  })],

  ['an exact split keeps the shape, and its join is C2 G2', () => withPage(async ({view, page, folder}) => {
    await page.getByRole('button', {name: /triangle/}).click();
    await view.quiet();
    const before = await lengthShown(page);
    await page.locator('input[type=number][aria-label="t"]').fill('0.3');
    await page.keyboard.press('Enter');
    await page.getByRole('button', {name: 'Split at t'}).click();
    await view.quiet();
    assert.ok(Math.abs(await lengthShown(page) - before) < 1e-6 * before);
    const joins = await joinsShown(page);
    assert.equal(joins.length, 1);
    assert.deepEqual(joins[0].slice(1, 3), ['C2', 'G2']);
    // Pulling the join's neighbour breaks it: the badge must say so, as the program does.
    const box = await page.locator('circle.point').nth(2).boundingBox();
    await page.mouse.move(box.x + 6, box.y + 6);
    await page.mouse.down();
    await page.mouse.move(box.x + 30, box.y + 50, {steps: 5});
    await page.mouse.up();
    await view.quiet();
    const [join] = retalho('curve', await saved(page, folder)).curves[0].joins;
    const [shown] = await joinsShown(page);
    assert.deepEqual(shown.slice(1, 3), [join.C, join.G]);
    assert.ok(Math.abs(Number(shown[4]) - join.angle) < 1e-3 * join.angle, `${shown[4]} against ${join.angle}`);
    assert.ok((await page.locator('.badge text').allTextContents()).includes(`${join.C} ${join.G}`));
  })],

  ['every example is drawn; comb and hodograph; the cusp of slide 6 is called one', () => withPage(async ({view, page, folder}) => {
    await page.getByRole('tab', {name: 'Curves'}).click();
    await view.quiet();
    const names = await page.$eval('select', () => [...document.querySelectorAll('.controls:not([hidden]) select option')].map((o) => o.textContent).filter((text) => text !== 'choose …'));
    const examples = names.slice(0, 10);
    for (const name of examples) {
      await example(view, name);
      const lengths = await page.$$eval('path.curve', (paths) => paths.map((path) => path.getAttribute('d').length));
      assert.ok(lengths.length > 0 && lengths.every((n) => n > 40), `${name}: ${lengths}`);
      assert.equal(await page.locator('.readout .error-words').count(), 0, name);
    }
    await example(view, 'Slide 6: a curve with a cusp');
    assert.equal((await joinsShown(page))[0][6], 'cusp');
    await example(view, 'Lagrange against splines (Runge)');
    await page.getByLabel('Curvature comb').check();
    await view.quiet();
    await view.picture('curves-runge');
    await example(view, 'B-spline');
    await page.getByLabel('Hodograph').check();
    await view.quiet();
    assert.ok(await page.locator('.hodograph').count() > 0);
    await view.picture('curves-comb');
    // The picture as a PNG: the same drawing, so that nearly every pixel of the curve's colour on the screen has it there.
    const saving = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save picture'}).click();
    const png = join(folder, 'curves.png');
    await (await saving).saveAs(png);
    const box = await page.locator('svg.curves').boundingBox();
    const screen = await page.screenshot({clip: box});
    const [drawn, seen] = await Promise.all([readFileSync(png), screen].map((bytes) => page.evaluate(async (base64) => {
      const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))]));
      const {width, height} = picture, context = new OffscreenCanvas(width, height).getContext('2d');
      context.drawImage(picture, 0, 0);
      const {data} = context.getImageData(0, 0, width, height);
      let blue = 0;
      for (let i = 0; i < data.length; i += 4) if (Math.abs(data[i] - 0x2a) < 24 && Math.abs(data[i + 1] - 0x8a) < 24 && Math.abs(data[i + 2] - 0xc4) < 24) ++blue;
      return {width, height, blue};
    }, bytes.toString('base64'))));
    assert.equal(drawn.width, 2 * seen.width);
    assert.ok(seen.blue > 500 && Math.abs(drawn.blue / (4 * seen.blue) - 1) < 0.35, `${drawn.blue} pixels of the curve's colour, ${seen.blue} on the screen`);
    const file = await saved(page, folder);
    assert.equal(JSON.parse(readFileSync(file, 'utf8')).curves[0].kind, 'bspline');
  })],

  ['draw a curve, type a formula, keys move a point, wrong input is said in words', () => withPage(async ({view, page, folder}) => {
    await page.getByRole('tab', {name: 'Curves'}).click();
    await view.quiet();
    await page.getByLabel('New curve').selectOption('spline');
    const before = await page.locator('circle.point').count();
    for (const [x, y] of [[500, 300], [640, 520], [860, 360]]) await page.mouse.click(x, y);
    await view.quiet();
    assert.equal(await page.locator('circle.point').count(), before + 3);
    await page.getByRole('button', {name: 'Move', exact: true}).click();
    await page.locator('circle.point').nth(3).focus();
    const was = await page.locator('circle.point').nth(3).boundingBox();
    await page.keyboard.press('ArrowRight');
    await view.quiet();
    await page.keyboard.press('ArrowRight');
    await view.quiet();
    const now = await page.locator('circle.point').nth(3).boundingBox();
    assert.ok(now.x > was.x + 2, 'the arrow keys move the point');
    await page.getByLabel('New curve').selectOption('implicit');
    await page.getByLabel('f(x, y) = 0').fill('x^2 - y^3 - 0.2');
    await page.keyboard.press('Enter');
    await view.quiet();
    const [, , implicit] = retalho('curve', await saved(page, folder)).curves;
    assert.equal(implicit.kind, 'implicit');
    assert.ok(await page.locator('path.curve').nth(2).evaluate((path) => path.getAttribute('d').length) > 40);
    await page.getByLabel('f(x, y) = 0').fill('x^2 +* y');
    await page.keyboard.press('Enter');
    await view.quiet();
    assert.ok((await page.locator('.readout .error-words').first().textContent()).length > 10);
    const file = join(folder, 'bad.json');
    writeFileSync(file, '{"curves": [{"kind": "bezier", "points": [[0]]}]}');
    await page.locator('.controls:not([hidden]) input[type=file]').setInputFiles(file);
    await page.waitForSelector('.hint.error-words:not(:empty)');
    assert.match(await page.textContent('.hint.error-words:not(:empty)'), /curves\[0\]/);
  })],
];
