// The triangular-surface view against `retalho patch --json` on the patch that the page saves.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
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

  ['a blade: the edge that its two patches share moves in both; undo; what is saved is the program’s', () => withPage([], 'Triangular surfaces', async ({view, page, folder, bar}) => {
    await bar.getByLabel('Surface shown').selectOption({label: 'Example: Blade'});
    await view.quiet();
    const names = await page.locator('.handles button').evaluateAll((buttons) => buttons.map((button) => button.getAttribute('aria-label')));
    assert.equal(names.length, 3 + 8, 'three corners and two points inside of each of four curves');
    const k = names.findIndex((name) => name.startsWith('leading edge, point 2'));
    const places = async () => JSON.parse(await page.locator('.patch-stage:not(.tetra-stage) canvas').getAttribute('data-handles'));
    const [x, y] = (await places())[k];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 1; i <= 8; ++i) await page.mouse.move(x + 3 * i, y - 6 * i);
    await page.mouse.up();
    await view.quiet();
    const shown = await listed(bar.locator('.readout').first());
    assert.match(shown['shared sides'], /all watertight/);
    const answer = await program(page, folder, '--recovery', 'smooth');
    assert.equal(answer.patches, 2);
    assert.equal(Number(shown.nodes), answer.nodes);
    near(Number(shown['boundary gap']), answer.boundary_gap, 1e-3, 1e-13, 'boundary gap');
    near(Number(shown['gradient jump']), answer.gradient_jump, 1e-3, 1e-11, 'gradient jump');
    near(parseFloat(shown['largest angle over them']), Math.max(...answer.joins.map((join) => join.angle)), 1e-3, 1e-6, 'angle over the edges');
    assert.ok(answer.joins.length > 0 && answer.joins.every((join) => join.watertight));
    await view.picture('patches-blade');
    await page.keyboard.press('Control+z');
    await view.quiet();
    assert.deepEqual((await places())[k], [x, y]);
  })],

  ['the keyboard moves a point: in the plane of the screen, along an axis, in steps of the snap; it is said aloud', () => withPage([], 'Triangular surfaces', async ({view, page, bar}) => {
    const handle = page.locator('.handles button').nth(1), canvas = page.locator('.patch-stage:not(.tetra-stage) canvas');
    const place = async () => JSON.parse(await canvas.getAttribute('data-handles'))[1];
    const point = async () => (await handle.getAttribute('aria-label')).split(': ')[1].replaceAll('−', '-').split(', ').map(Number);
    await handle.focus();
    await view.quiet();
    const [x, y] = await place(), p = await point();
    await page.keyboard.press('Shift+ArrowRight');
    await view.quiet();
    const right = await place();
    assert.ok(right[0] > x + 8 && Math.abs(right[1] - y) <= 2, `moved from ${[x, y]} to ${right}`);
    await page.keyboard.press('ArrowUp');
    await view.quiet();
    const up = await place();
    assert.ok(up[1] < right[1] && Math.abs(up[0] - right[0]) <= 2, `moved from ${right} to ${up}`);
    const before = await point();
    await page.keyboard.press('z');
    await view.quiet();
    const after = await point();
    assert.ok(after[2] > before[2] && after[0] === before[0] && after[1] === before[1], `z alone: ${before} to ${after}`);
    assert.match(await page.locator('.unseen').textContent(), /^Side 1, point 2: /);
    await bar.getByLabel('Snap to').selectOption('0.5');
    await handle.focus();
    await page.keyboard.press('Shift+X');
    await view.quiet();
    const snappedTo = await point();
    assert.ok(snappedTo.every((v) => Number.isInteger(2 * v)), `on the grid of 0.5: ${snappedTo}`);
    assert.ok(snappedTo[0] < after[0]);
    for (let k = 0; k < 8 && JSON.stringify(await point()) !== JSON.stringify(p); ++k) {
      await page.keyboard.press('Control+z');
      await view.quiet();
    }
    assert.deepEqual(await point(), p, 'undo brings it back');
  })],

  ['OBJ, GLB and the parameter triangle are saved', () => withPage([], 'Triangular surfaces', async ({view, page, folder, bar}) => {
    const save = async (name) => {
      const saving = page.waitForEvent('download');
      await bar.getByRole('button', {name}).click();
      const file = join(folder, 'saved');
      await (await saving).saveAs(file);
      return readFileSync(file);
    };
    const triangles = Number((await listed(bar.locator('.readout').first())).triangles);
    const obj = (await save('Save OBJ')).toString();
    const faces = obj.split('\n').filter((line) => line.startsWith('f ')).length;
    assert.equal(faces, 4 * triangles, 'n = 24 is drawn with twice as many pieces a side');
    assert.ok(obj.split('\n').filter((line) => line.startsWith('vn ')).length > 100);
    const glb = await save('Save GLB');
    assert.equal(glb.toString('latin1', 0, 4), 'glTF');
    assert.equal(glb.readUInt32LE(8), glb.length);
    const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString());
    assert.ok(json.accessors.some((accessor) => accessor.count === 3 * faces));
    const svg = (await save('Save triangle as SVG')).toString();
    assert.match(svg, /^<svg xmlns="http:\/\/www.w3.org\/2000\/svg"|^<svg [^>]*xmlns=/);
    assert.equal((svg.match(/<line /g) ?? []).length, 18, 'fifteen lines and three sides');
    await view.quiet();
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
