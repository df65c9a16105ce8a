// The TetraQuad view: the shader's hits against the program's ray caster, and its edits against `retalho reconstruct`.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {listed, retalho, View, withPage, writeEgg} from './support.mjs';

const LIMIT = 1e-3;  // of a cell

/** Clicks a grid of places of the picture: how many rays hit, and the largest distance of the two hits. */
async function probe(view, bar, columns, rows) {
  const box = await view.page.locator('.tetra-stage canvas').boundingBox();
  let hits = 0, worst = 0, misses = 0;
  for (let r = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      await view.page.mouse.click(box.x + box.width * (0.3 + (0.4 * (c + 0.5)) / columns), box.y + box.height * (0.25 + (0.5 * (r + 0.5)) / rows));
      await view.quiet();
      const text = await bar.locator('.readout.answer').textContent();
      if (/Nothing is hit/.test(text)) continue;
      const off = (await listed(bar.locator('.readout.answer')))['the picture’s hit is off by'];
      if (off === undefined || /nothing/.test(off)) { ++misses; continue; }
      ++hits;
      worst = Math.max(worst, parseFloat(off));
    }
  }
  return {hits, worst, misses};
}

export const tests = [
  ['the shader’s hit is the program’s, to a thousandth of a cell, on every example', () => withPage([], 'TetraQuads', async ({view, page, bar}) => {
    await bar.getByLabel('Ask where one clicks').check();
    const names = (await bar.getByLabel('Surface', {exact: true}).locator('option').allTextContents()).filter((name) => name.startsWith('Example'));
    assert.equal(names.length, 6);
    let all = 0;
    for (const name of names) {
      await bar.getByLabel('Surface', {exact: true}).selectOption({label: name});
      await view.quiet();
      const {hits, worst, misses} = await probe(view, bar, 3, 2);
      console.log(`   ${name}: ${hits} rays hit, largest difference ${worst} of a cell, ${misses} seen by one of the two only`);
      assert.ok(worst <= LIMIT, `${name}: ${worst}`);
      assert.equal(misses, 0, name);
      all += hits;
    }
    assert.ok(all >= 12, `${all} rays hit a surface`);
    await page.getByLabel('Tetrahedra on the surface').check();
    await view.quiet();
    await view.picture('tetraquads-jump');
  })],

  ['a quadric’s slider moves the surface, the cut opens it; what is saved is what the program makes of it', () => withPage([], 'TetraQuads', async ({view, page, folder, bar}) => {
    await bar.getByLabel('Ask where one clicks').check();
    const box = await page.locator('.tetra-stage canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await view.quiet();
    const before = await listed(bar.locator('.readout.answer'));
    await bar.getByLabel('Cut').selectOption('x');
    await view.quiet();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await view.quiet();
    const cut = await listed(bar.locator('.readout.answer'));
    assert.ok(parseFloat(cut['the picture’s hit is off by']) <= LIMIT, JSON.stringify(cut));
    assert.notEqual(cut.point, before.point, 'the ray goes through the cut');
    await view.picture('tetraquads-cut');
    await bar.getByLabel('Cut').selectOption('none');
    await bar.getByLabel('Vertex').selectOption({index: 1});
    await page.locator('input[type=number][aria-label="constant"]').fill('-0.6');
    await page.keyboard.press('Enter');
    await view.quiet();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await view.quiet();
    const after = await listed(bar.locator('.readout.answer'));
    assert.notEqual(after.point, before.point, 'the surface follows');
    assert.ok(parseFloat(after['the picture’s hit is off by']) <= LIMIT);
    const saving = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save quadrics'}).click();
    const file = join(folder, 'quadrics.json');
    await (await saving).saveAs(file);
    const answer = retalho('reconstruct', file, '-o', join(folder, 'model.retalho'));
    assert.equal(answer.tetrahedra, 1);
    for (const format of ['retalho', 'obj', 'glb']) {
      const downloading = page.waitForEvent('download'), made = join(folder, `program.${format}`);
      await bar.getByRole('button', {name: format === 'retalho' ? 'Save model' : `Save ${format.toUpperCase()}`}).click();
      await (await downloading).saveAs(join(folder, `page.${format}`));
      retalho('reconstruct', file, '-o', made);
      assert.deepEqual(readFileSync(join(folder, `page.${format}`)), readFileSync(made), `the ${format} is the program’s, byte for byte`);
    }
    const model = await View.open([join(folder, 'model.retalho')]);
    try {
      await model.go();
      assert.equal((await listed(model.page.locator('.facts'))).tetrahedra, '1', 'a model given on the command line is shown first');
    } finally {
      await model.close();
    }
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await view.quiet();
  })],

  ['points become a surface, coarse first and then finer, as `retalho reconstruct` makes it', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'retalho-points-'));
    const cloud = join(folder, 'egg.xyz');
    writeEgg(cloud, 4000);
    try {
      await withPage([cloud], 'TetraQuads', async ({view, page, bar}) => {
        await page.locator('input[type=number][aria-label^="Resolution"]').fill('10');
        await page.keyboard.press('Enter');
        await view.quiet();
        const shown = await listed(bar.locator('.facts'));
        const answer = retalho('reconstruct', cloud, '-o', join(folder, 'egg.ply'), '--resolution', '10');
        assert.equal(Number(shown.resolution), 10);
        assert.equal(Number(shown.tetrahedra), answer.tetrahedra);
        assert.equal(Number(shown.points), 4000);
        assert.ok(Math.abs(Number(shown['mean distance of the points']) - answer.residual_mean) < 1e-3 * answer.residual_mean);
        await bar.getByLabel('Ask where one clicks').check();
        const {hits, worst, misses} = await probe(view, bar, 2, 1);
        console.log(`   egg: ${hits} rays hit, largest difference ${worst} of a cell`);
        assert.ok(hits === 2 && worst <= LIMIT && misses === 0);
        await view.picture('tetraquads-points');
      });
    } finally {
      rmSync(folder, {recursive: true});
    }
  }],

  ['a file of quadrics given on the command line', () => withPage([fileURLToPath(new URL('../../../examples/tetraquads/ellipsoids-4.json', import.meta.url))], 'TetraQuads', async ({view, bar}) => {
    assert.equal((await listed(bar.locator('.facts'))).tetrahedra, '1');
    await view.picture('tetraquads-ellipsoids');
  })],
];
