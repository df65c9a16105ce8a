// The terrain view against the program's own answers on the same grid.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {retalho, View, writeHills} from './support.mjs';

const MODEL = ['--surface', 'clough-tocher', '--fit', 'interpolate', '--max-error', '5'];

/** The numbers of a list of names and values (dt, dd) below `selector`. */
async function numbers(page, selector) {
  return page.$eval(selector, (box) => Object.fromEntries([...box.querySelectorAll('dt')].map((dt) => [dt.textContent, parseFloat(dt.nextElementSibling.textContent.replace('−', '-'))])));
}

function near(a, b, relative, words) {
  assert.ok(Math.abs(a - b) <= relative * Math.max(1, Math.abs(b)), `${words}: the page says ${a}, the program ${b}`);
}

async function withGrid(run) {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-terrain-'));
  const dem = join(folder, 'hills.asc'), model = join(folder, 'hills.retalho');
  writeHills(dem, 160, 120);
  const report = retalho('fit', dem, '-o', model, ...MODEL);
  const view = await View.open([dem]);
  try {
    await view.go();
    await run({view, page: view.page, dem, model, report, folder});
    assert.deepEqual(view.problems, [], 'the browser reports no error');
    const elsewhere = view.requests.filter((url) => !/^(http:\/\/127\.0\.0\.1:\d+\/|blob:)/.test(url));
    assert.deepEqual(elsewhere, [], 'no request leaves the machine');
  } finally {
    assert.equal(await view.close(), 0, 'Ctrl-C ends the program with code 0');
    rmSync(folder, {recursive: true});
  }
}

async function tool(view, name) {
  await view.page.locator('.tools').getByRole('button', {name}).click();
}

export const tests = [
  ['the surface, its report and its errors are the program’s', () => withGrid(async ({view, page, report, model, folder}) => {
    await page.getByLabel('Tolerance', {exact: true}).first().waitFor();
    await page.locator('input[type=number][aria-label="Tolerance"]').fill('5');
    await page.keyboard.press('Enter');
    await view.quiet();
    const shown = await numbers(page, '.stage .overlay');
    near(shown.vertices, report.vertices, 0, 'vertices');
    near(shown.coefficients, report.coefficients, 0, 'coefficients');
    near(shown.RMSE, report.rmse, 1e-3, 'RMSE');
    near(shown['largest error'], report.max_error, 1e-3, 'largest error');
    near(shown['slope RMSE'], report.slope_rmse, 5e-3, 'slope RMSE');
    await view.picture('terrain-relief');
    const saving = page.waitForEvent('download');
    await page.locator('.controls:not([hidden])').getByRole('button', {name: 'Save model'}).click();
    const file = join(folder, 'saved.retalho');
    await (await saving).saveAs(file);
    assert.deepEqual(readFileSync(file), readFileSync(model), 'the saved model is the program’s, byte for byte');
    for (const format of ['obj', 'glb']) {
      const downloading = page.waitForEvent('download'), mesh = join(folder, `program.${format}`);
      await page.locator('.controls:not([hidden])').getByRole('button', {name: `Save ${format.toUpperCase()}`}).click();
      const download = await downloading;
      assert.equal(download.suggestedFilename(), `hills.${format}`);
      await download.saveAs(join(folder, `page.${format}`));
      retalho('mesh', model, '-o', mesh);
      assert.deepEqual(readFileSync(join(folder, `page.${format}`)), readFileSync(mesh), `the ${format} is the program’s, byte for byte`);
    }
    await page.locator('.controls:not([hidden])').getByLabel('Colour').selectOption('error');
    await view.quiet();
    const top = await page.$eval('.legend .ticks span:last-child', (span) => parseFloat(span.textContent));
    near(top, report.max_error, 1e-3, 'the end of the errors’ legend');
    await view.picture('terrain-error');
  })],

  ['a click says height, slope and coordinates as `retalho sample` does', () => withGrid(async ({view, page, model}) => {
    await page.locator('input[type=number][aria-label="Tolerance"]').fill('5');
    await page.keyboard.press('Enter');
    await view.quiet();
    await tool(view, 'Ask');
    for (const [x, y] of [[700, 420], [860, 520], [640, 600]]) {
      await page.mouse.click(x, y);
      await view.quiet();
      const said = await numbers(page, '.readout');
      const [point] = retalho('sample', model, '--at', `${said.X},${said.Y}`, '--what', 'height', '--what', 'slope').points;
      near(said.height, point.z, 2e-5, 'height');
      near(said.slope, point.slope, 1e-3, 'slope');
    }
    // The same place by its numbers, from the keyboard.
    await page.getByLabel('X in the CRS').fill('1503.25');
    await page.getByLabel('Y in the CRS').fill('2604.5');
    await page.keyboard.press('Enter');
    await view.quiet();
    const said = await numbers(page, '.readout');
    near(said.X, 1503.25, 1e-9, 'X');
    const [point] = retalho('sample', model, '--at', '1503.25,2604.5', '--what', 'height', '--what', 'slope').points;
    near(said.height, point.z, 1e-7, 'height');
    near(said.slope, point.slope, 1e-5, 'slope');
  })],

  ['contours, profile and viewshed', () => withGrid(async ({view, page, dem, model, folder}) => {
    await page.locator('input[type=number][aria-label="Tolerance"]').fill('5');
    await page.keyboard.press('Enter');
    await page.locator('input[type=number][aria-label^="Interval"]').fill('25');
    await page.keyboard.press('Enter');
    await view.quiet();
    const lines = retalho('contour', model, '-o', join(folder, 'lines.geojson'), '--interval', '25');
    const words = await page.$eval('.stage .overlay', (box) => box.textContent);
    assert.match(words, new RegExp(`${lines.lines} lines on `));
    await page.getByLabel('Triangles', {exact: true}).check();
    await view.quiet();
    await view.picture('terrain-contours');

    await tool(view, 'Profile');
    await page.mouse.click(620, 470);
    await page.mouse.click(900, 530);
    await view.quiet();
    assert.equal(await page.locator('.chart .series').count(), 2, 'the surface and the grid');

    await tool(view, 'Viewshed');
    await page.mouse.click(760, 470);
    await view.quiet();
    const seen = Number(/(\d+) of (\d+) cells are seen/.exec(await page.$eval('.seen', (p) => p.textContent))[1]);
    await tool(view, 'Ask');
    await page.mouse.click(760, 470);
    await view.quiet();
    const at = await numbers(page, '.readout');
    const answer = retalho('viewshed', dem, '-o', join(folder, 'seen.tif'), '--observer', `${at.X},${at.Y}`, '--observer-height', '2');
    assert.equal(seen, answer.visible_cells);
    await view.picture('terrain-viewshed');
  })],

  ['what is near is drawn finer, and no two levels leave a crack', () => withGrid(async ({view, page, folder}) => {
    await page.locator('input[type=number][aria-label="Tolerance"]').fill('25');
    await page.keyboard.press('Enter');
    await view.quiet();
    const detail = async () => JSON.parse(await page.locator('.stage .overlay').getAttribute('data-detail'));
    const far = await detail();
    await page.mouse.move(760, 470);
    for (let k = 0; k < 14; ++k) await page.mouse.wheel(0, -240);
    await view.quiet();
    const near = await detail();
    assert.ok(near.finest > far.finest, `${near.finest} pieces an edge near, ${far.finest} from afar`);
    assert.ok(near.triangles <= 18_000, `${near.triangles} triangles`);
    await view.picture('terrain-near');
    // Straight down on the inside of the terrain every pixel is ground: a crack would let the sky through.
    const saving = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save picture'}).click();
    const file = join(folder, 'near.png');
    await (await saving).saveAs(file);
    const {sky, pixels} = await page.evaluate(async (png) => {
      const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(png), (c) => c.charCodeAt(0))]));
      const {width, height} = picture, context = new OffscreenCanvas(width, height).getContext('2d');
      context.drawImage(picture, 0, 0);
      const colour = getComputedStyle(document.querySelector('.stage')).getPropertyValue('--sky').trim();
      const rgb = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
      const {data} = context.getImageData(width * 0.3, height * 0.6, width * 0.4, height * 0.3);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (rgb.every((v, k) => Math.abs(data[i + k] - v) <= 2)) ++count;
      return {sky: count, pixels: data.length / 4};
    }, readFileSync(file).toString('base64'));
    assert.ok(pixels > 50_000);
    assert.equal(sky, 0, `${sky} of ${pixels} pixels show the sky`);
  })],

  ['the keyboard alone: move, turn, zoom, a profile and a viewshed by numbers', () => withGrid(async ({view, page, dem, folder}) => {
    await page.locator('input[type=number][aria-label="Tolerance"]').fill('5');
    await page.keyboard.press('Enter');
    await view.quiet();
    const camera = async () => {
      await page.getByRole('button', {name: 'Link'}).press('Enter');
      return JSON.parse(Buffer.from((await page.evaluate(() => location.hash)).replace('#view=', ''), 'base64url').toString()).terrain.camera;
    };
    const press = async (...keys) => {
      await page.locator('.terrain .stage > canvas').focus();
      for (const key of keys) await page.keyboard.press(key);
      await view.quiet();
      return camera();
    };
    const distance = (c) => Math.hypot(c[0] - c[3], c[1] - c[4], c[2] - c[5]);
    const first = await press('ArrowRight'), near = await press('+', '+', '+', '+', '+');
    assert.ok(Math.abs(distance(near) / distance(first) - 1.15 ** -5) < 1e-3, 'plus zooms in');
    const turned = await press('Shift+ArrowRight', 'Shift+ArrowRight');
    assert.ok(Math.abs(distance(turned) - distance(near)) < 1e-3 * distance(near));
    const angle = (c) => Math.atan2(c[1] - c[4], c[0] - c[3]) * 180 / Math.PI;
    assert.ok(Math.abs(angle(turned) - angle(near) - 10) < 0.01, 'two turns of five degrees');
    const moved = await press('ArrowLeft', 'ArrowLeft');
    assert.ok(Math.hypot(moved[3] - turned[3], moved[4] - turned[4]) > 5, 'arrows move what is looked at');

    const go = async (x, y) => {
      await page.getByLabel('X in the CRS').fill(String(x));
      await page.getByLabel('Y in the CRS').fill(String(y));
      await page.keyboard.press('Enter');
      await view.quiet();
    };
    await page.locator('.tools').getByRole('button', {name: 'Profile'}).press('Enter');
    await go(1200, 2200);
    await go(2300, 2900);
    assert.equal(await page.locator('.chart .series').count(), 2);
    assert.match(await page.locator('.chart').getAttribute('aria-label'), /^Profile of 1303\.8/);
    await page.locator('.tools').getByRole('button', {name: 'Viewshed'}).press('Enter');
    await go(1755, 2605);
    const seen = Number(/(\d+) of (\d+) cells are seen/.exec(await page.$eval('.seen', (p) => p.textContent))[1]);
    assert.equal(seen, retalho('viewshed', dem, '-o', join(folder, 'seen.tif'), '--observer', '1755,2605', '--observer-height', '2').visible_cells);
    await go(99999, 2605);
    assert.match(await page.locator('.controls:not([hidden])').textContent(), /There is no terrain there/);
  })],

  ['three surfaces side by side; undo, redo, the link and a saved view bring them back', () => withGrid(async ({view, page, folder}) => {
    await page.getByLabel('Side by side').selectOption('3');
    await view.quiet();
    assert.equal(await page.locator('.stage .overlay').count(), 3);
    const [flat, paper, ours] = await page.$$eval('.stage .overlay', (boxes) => boxes.map((box) => box.querySelector('p').textContent));
    assert.notEqual(paper, ours);
    assert.equal(flat, paper);
    await view.picture('terrain-three');
    await page.getByLabel('Vertical exaggeration of the picture').first().fill('500');
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await view.quiet();
    assert.equal(await page.locator('.stage .overlay').count(), 1);
    await page.keyboard.press('Control+Shift+z');
    await view.quiet();
    assert.equal(await page.locator('.stage .overlay').count(), 3);

    const saving = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save view'}).click();
    const file = join(folder, 'view.json');
    await (await saving).saveAs(file);
    assert.equal(JSON.parse(readFileSync(file, 'utf8')).terrain.panels.length, 3);
    await page.getByLabel('Side by side').selectOption('1');
    await view.quiet();
    await page.locator('input.open-view').setInputFiles(file);
    await view.quiet();
    assert.equal(await page.locator('.stage .overlay').count(), 3);

    await page.getByRole('button', {name: 'Link'}).click();
    assert.ok(!page.url().includes('token'), 'the token is not in the address');
    await page.reload();
    await view.quiet();
    assert.equal(await page.locator('.stage .overlay').count(), 3);
    await page.getByRole('button', {name: /^Theme/}).click();
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
    await view.quiet();
    await view.picture('terrain-dark');
  })],

  ['what is wrong is said in words', () => withGrid(async ({view, page}) => {
    await page.getByLabel('Fineness by').selectOption('vertices');
    await page.getByLabel('Fit').selectOption('surface');
    await page.locator('input[type=number][aria-label="Vertices"]').fill('300');
    await page.keyboard.press('Enter');
    await view.quiet();
    const address = page.url();
    view.server.removeAllListeners('exit');
    await page.goto('about:blank');
    await page.evaluate(() => undefined);
    await page.goto(address);
    await view.quiet();
    await page.evaluate(() => sessionStorage.clear());
    await page.reload();
    await page.waitForSelector('main.failure[role=alert]');
    assert.match(await page.textContent('main.failure'), /token/);
  })],
];
