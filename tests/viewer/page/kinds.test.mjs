// Every kind of file that `retalho view` takes is shown in its view, and its numbers are the program's.
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {listed, retalho, View, writeEgg, writeHills} from './support.mjs';

const example = (name) => fileURLToPath(new URL(`../../../examples/${name}`, import.meta.url));

/** Opens the files, waits for the picture, and gives the tab that is shown first. */
async function opened(files, run) {
  const view = await View.open(files);
  try {
    await view.go();
    const tab = await view.page.locator('[role=tab][aria-selected=true]').textContent();
    await run({view, page: view.page, tab, bar: view.page.locator('.controls:not([hidden])')});
    assert.deepEqual(view.problems, [], 'the browser reports no error');
  } finally {
    assert.equal(await view.close(), 0);
  }
}

async function withFolder(run) {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-kinds-'));
  try {
    await run(folder);
  } finally {
    rmSync(folder, {recursive: true});
  }
}

export const tests = [
  ['a document of curves', () => opened([example('curves/hermite.json')], async ({view, page, tab, bar}) => {
    assert.equal(tab, 'Curves');
    const [first] = retalho('curve', example('curves/hermite.json')).curves;
    const shown = await listed(bar.locator('.readout'));
    assert.ok(Math.abs(Number(shown.length) - first.length) <= 1e-6 * first.length, `${shown.length} against ${first.length}`);
    assert.equal(await bar.getByLabel('Example').locator('option', {hasText: 'hermite.json'}).count(), 1);
    await page.getByRole('tab', {name: 'Start'}).click();
    await page.getByRole('button', {name: /hermite\.json/}).click();
    await view.quiet();
    assert.equal(await page.locator('[role=tab][aria-selected=true]').textContent(), 'Curves');
  })],

  ['patches as JSON are changed, a model of patches is looked at', () => withFolder(async (folder) => {
    const model = join(folder, 'hull.retalho'), program = retalho('patch', example('patches/hull.json'), '-o', model);
    await opened([example('patches/hull.json'), model], async ({view, page, tab, bar}) => {
      assert.equal(tab, 'Triangular surfaces');
      assert.equal(await bar.getByLabel('Divisions of each side, n').first().isVisible(), true);
      await view.picture('kinds-hull');
      for (const source of [null, 'hull.retalho']) {
        if (source) await bar.getByLabel('Surface shown').selectOption({label: source});
        await view.quiet();
        const shown = await listed(bar.locator('.readout').first());
        assert.equal(Number(shown.nodes), program.nodes, String(source));
        assert.equal(Number(shown.triangles), program.triangles);
        assert.ok(Math.abs(Number(shown['gradient jump']) - program.gradient_jump) <= 1e-3 * program.gradient_jump + 1e-11);
        assert.equal(shown['shared sides'], `${program.joins.length}, all watertight`);
        const angle = Math.max(...program.joins.map((join) => join.angle));
        assert.ok(Math.abs(parseFloat(shown['largest angle over them']) - angle) <= 1e-3 * angle, `${shown['largest angle over them']} against ${angle}`);
      }
      assert.equal(await bar.getByLabel('Divisions of each side, n').first().isVisible(), false, 'a model is not made anew');
      assert.equal(await page.locator('.handles').isVisible(), false);
      await bar.getByLabel('Patch', {exact: true}).selectOption({label: 'bow starboard'});
      await view.quiet();
      await bar.getByLabel('Colour').selectOption('zebra');
      await view.quiet();
      await view.picture('kinds-hull-model');
    });
  })],

  ['a tiled model is one terrain', () => withFolder(async (folder) => {
    const dem = join(folder, 'hills.asc'), tiles = join(folder, 'tiles');
    writeHills(dem, 160, 120);
    retalho('fit', dem, '-o', tiles, '--tiles', '64', '--max-error', '5');
    const {vertices} = retalho('info', tiles);
    await opened([tiles], async ({view, page, tab}) => {
      assert.equal(tab, 'Terrain');
      assert.equal(Number((await listed(page.locator('.stage .overlay'))).vertices), vertices);
      await page.getByLabel('X in the CRS').fill('1503.25');
      await page.getByLabel('Y in the CRS').fill('2604.5');
      await page.keyboard.press('Enter');
      await view.quiet();
      const said = await listed(page.locator('.controls:not([hidden]) .readout'));
      const [point] = retalho('sample', tiles, '--at', '1503.25,2604.5', '--what', 'height').points;
      assert.ok(Math.abs(parseFloat(said.height) - point.z) < 1e-5 * Math.abs(point.z), `${said.height} against ${point.z}`);
    });
  })],

  ['an adaptive TetraQuad: the shader’s hits are the program’s', () => withFolder(async (folder) => {
    const cloud = join(folder, 'egg.xyz'), model = join(folder, 'egg.retalho');
    writeEgg(cloud, 4000);
    const report = retalho('reconstruct', cloud, '-o', model, '--adaptive', '3000', '--smoothness', '0.1');
    await opened([model], async ({view, page, tab, bar}) => {
      assert.equal(tab, 'TetraQuads');
      assert.equal(Number((await listed(bar.locator('.facts'))).tetrahedra), report.tetrahedra);
      await view.picture('kinds-adaptive');
      await bar.getByLabel('Ask where one clicks').check();
      const box = await page.locator('.tetra-stage canvas').boundingBox();
      let hits = 0;
      for (const [x, y] of [[0.5, 0.5], [0.45, 0.42], [0.55, 0.55], [0.42, 0.52]]) {
        await page.mouse.click(box.x + box.width * x, box.y + box.height * y);
        await view.quiet();
        const off = (await listed(bar.locator('.readout.answer')))['the picture’s hit is off by'];
        if (off === undefined) continue;
        ++hits;
        assert.ok(parseFloat(off) <= 1e-3, off);
      }
      assert.ok(hits >= 3, `${hits} rays hit`);
    });
  })],

  ['several kinds together: the first one is shown, the start page has them all', () => withFolder(async (folder) => {
    const cloud = join(folder, 'egg.xyz');
    writeEgg(cloud, 500);
    await opened([example('tetraquads/sphere.json'), example('curves/slide6.json'), cloud, example('patches/blade.json')], async ({view, page, tab}) => {
      assert.equal(tab, 'TetraQuads');
      await page.getByRole('tab', {name: 'Start'}).click();
      for (const [card, view_] of [[/slide6\.json/, 'Curves'], [/egg\.xyz/, 'TetraQuads'], [/blade\.json/, 'Triangular surfaces'], [/sphere\.json/, 'TetraQuads']]) {
        await page.getByRole('tab', {name: 'Start'}).click();
        await page.getByRole('button', {name: card}).click();
        await view.quiet();
        assert.equal(await page.locator('[role=tab][aria-selected=true]').textContent(), view_, String(card));
      }
      await view.picture('kinds-start');
    });
  })],
];
