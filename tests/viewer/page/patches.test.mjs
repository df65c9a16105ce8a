// The triangular-surface view against `retalho patch --json` on the patch that the page saves.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {listed, retalho, withPage} from './support.mjs';

async function program(page, folder, ...more) {
  const saving = page.waitForEvent('download');
  await page.getByRole('button', {name: 'Save patch'}).click();
  const file = join(folder, 'patch.json'), model = join(folder, 'patch.ply');
  await (await saving).saveAs(file);
  return retalho('patch', file, '-o', model, '--overwrite', ...more);
}

function near(a, b, relative, absolute, words) {
  assert.ok(Math.abs(a - b) <= relative * Math.abs(b) + absolute, `${words}: the page says ${a}, the program ${b}`);
}

export const tests = [
  ['a dragged point: the surface, its gap and its jump are the program’s, in all recoveries', () => withPage([], 'Triangular surfaces', async ({view, page, folder, bar}) => {
    await view.picture('patches-light');
    const before = await listed(bar.locator('.readout').first());
    const handles = JSON.parse(await page.locator('.patch-stage:not(.tetra-stage) canvas').getAttribute('data-handles'));
    const [x, y] = handles[1];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let k = 1; k <= 12; ++k) await page.mouse.move(x + 5 * k, y - 4 * k);
    await page.mouse.up();
    await view.quiet();
    const moved = JSON.parse(await page.locator('.patch-stage:not(.tetra-stage) canvas').getAttribute('data-handles'))[1];
    assert.ok(Math.hypot(moved[0] - x - 60, moved[1] - y + 48) < 4, `the point lies under the pointer: ${moved} from ${[x, y]}`);
    for (const [label, recovery] of [['smooth', 'smooth'], ['spr', 'spr'], ['barycentric', 'barycentric']]) {
      await bar.getByLabel('Recovery').selectOption(label);
      await view.quiet();
      const shown = await listed(bar.locator('.readout').first());
      const answer = await program(page, folder, '--recovery', recovery);
      near(Number(shown.nodes), answer.nodes, 0, 0, 'nodes');
      near(Number(shown['boundary gap']), answer.boundary_gap, 1e-3, 1e-13, `boundary gap, ${recovery}`);
      near(Number(shown['gradient jump']), answer.gradient_jump, 1e-3, 1e-11, `gradient jump, ${recovery}`);
      if (recovery !== 'smooth') assert.ok(answer.gradient_jump > 1e-6, 'the other recoveries have a jump that can be told');
    }
    assert.ok(before.nodes > 0);
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await page.keyboard.press('Control+z');
    await view.quiet();
    const back = JSON.parse(await page.locator('.patch-stage:not(.tetra-stage) canvas').getAttribute('data-handles'))[1];
    assert.deepEqual(back, [x, y], 'undo brings the point back');
  })],

  ['the cursor of the parameter triangle is a point of the surface', () => withPage([], 'Triangular surfaces', async ({view, page, folder, bar}) => {
    const box = await bar.locator('.parameters').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height * 0.6);
    await view.quiet();
    const shown = await listed(bar.locator('.cursor-words'));
    const [u, v] = shown['u, v'].split(', ').map(Number);
    assert.ok(u > 0.05 && v > 0.05 && u + v < 0.95);
    const [answer] = (await program(page, folder, '--at', `${u},${v}`)).points;
    shown.point.split(', ').map(Number).forEach((value, k) => near(value, answer.point[k], 0, 2e-3, `coordinate ${k}`));
    near(Number(shown.Gaussian), answer.gaussian, 0.02, 1e-3, 'Gaussian curvature');
    // On the surface itself: the same place, from the other side.
    const handles = JSON.parse(await page.locator('.patch-stage:not(.tetra-stage) canvas').getAttribute('data-handles'));
    const middle = handles.reduce(([a, b], [x, y]) => [a + x / handles.length, b + y / handles.length], [0, 0]);
    await page.mouse.move(...middle);
    await view.quiet();
    const under = await listed(bar.locator('.cursor-words'));
    assert.ok(under['u, v'], 'the cursor is on the surface');
  })],

  ['zebra, isophotes, parameter lines, curvature and error colours have their pictures and legends', () => withPage([], 'Triangular surfaces', async ({view, page, bar}) => {
    for (const style of ['lines', 'zebra', 'isophotes', 'error', 'gaussian', 'mean']) {
      await bar.getByLabel('Colour').selectOption(style);
      await view.quiet();
      await view.picture(`patches-${style}`);
      assert.equal(await page.locator('.patch-legend:not([hidden]) .legend').count(), ['error', 'gaussian', 'mean'].includes(style) ? 1 : 0, style);
    }
    await bar.getByLabel('Triangles as drawn').check();
    await page.locator('input[type=number][aria-label="Divisions of each side, n"]').fill('64');
    await page.keyboard.press('Enter');
    await view.quiet();
    assert.equal((await listed(bar.locator('.readout').first())).triangles, '4096');
  })],
];
