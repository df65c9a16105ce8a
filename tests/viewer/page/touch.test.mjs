// The page under fingers, at a phone's size: pinch zooms, two fingers move, one turns or drags a point.
import assert from 'node:assert/strict';
import {withPage} from './support.mjs';

const PHONE = {viewport: {width: 412, height: 860}, hasTouch: true};

/** Fingers that go from one list of places to another. */
async function fingers(view, from, to, steps = 8) {
  const cdp = await view.context.newCDPSession(view.page);
  const points = (t) => from.map(([x, y], id) => ({id, x: x + (to[id][0] - x) * t, y: y + (to[id][1] - y) * t}));
  await cdp.send('Input.dispatchTouchEvent', {type: 'touchStart', touchPoints: points(0).slice(0, 1)});
  if (from.length > 1) await cdp.send('Input.dispatchTouchEvent', {type: 'touchStart', touchPoints: points(0)});
  for (let k = 1; k <= steps; ++k) {
    await cdp.send('Input.dispatchTouchEvent', {type: 'touchMove', touchPoints: points(k / steps)});
    await view.page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
  }
  await cdp.send('Input.dispatchTouchEvent', {type: 'touchEnd', touchPoints: []});
  await cdp.detach();
  await view.quiet();
}

/** What the page's link holds. */
async function state(view) {
  await view.page.getByRole('button', {name: 'Link'}).click();
  return JSON.parse(Buffer.from((await view.page.evaluate(() => location.hash)).replace('#view=', ''), 'base64url').toString());
}

async function middle(locator) {
  await locator.scrollIntoViewIfNeeded();
  const box = await locator.boundingBox();
  return {...box, left: box.x, x: box.x + box.width / 2, y: box.y + box.height / 2};
}

const distance = (camera) => Math.hypot(...[0, 1, 2].map((k) => camera[k] - camera[k + 3]));

export const tests = [
  ['terrain and surfaces: pinch zooms, two fingers move, one turns', async () => {
    for (const [tab, canvas, part] of [['Terrain', '.terrain .stage > canvas', 'terrain'], ['Triangular surfaces', '.patch-stage:not(.tetra-stage) canvas', 'patches'], ['TetraQuads', '.tetra-stage canvas', 'tetraquads']]) {
      await withPage([], tab, async ({view, page}) => {
        await view.picture(`phone-${part}`);
        const {x, y} = await middle(page.locator(canvas));
        // First a finger's turn, so that the camera is in the state.
        await fingers(view, [[x - 90, y + 110]], [[x - 60, y + 110]]);
        const first = (await state(view))[part].camera;
        await fingers(view, [[x - 40, y], [x + 40, y]], [[x - 110, y], [x + 110, y]]);
        const near = (await state(view))[part].camera;
        assert.ok(distance(near) < 0.6 * distance(first), `${tab}: pinch: ${distance(first)} to ${distance(near)}`);
        await fingers(view, [[x - 110, y], [x + 110, y]], [[x - 40, y], [x + 40, y]]);
        const far = (await state(view))[part].camera;
        assert.ok(distance(far) > 1.5 * distance(near), `${tab}: pinch back: ${distance(near)} to ${distance(far)}`);
        await fingers(view, [[x - 30, y], [x + 30, y]], [[x + 30, y + 40], [x + 90, y + 40]]);
        const moved = (await state(view))[part].camera;
        const way = Math.hypot(...[3, 4, 5].map((k) => moved[k] - far[k]));
        assert.ok(way > 0.02 * distance(far), `${tab}: two fingers move the target by ${way}`);
        assert.ok(Math.abs(distance(moved) / distance(far) - 1) < 0.1, `${tab}: and do not zoom`);
        const before = (await state(view))[part].camera;
        await fingers(view, [[x - 90, y + 110]], [[x + 20, y + 110]]);
        const turned = (await state(view))[part].camera;
        assert.ok(Math.abs(distance(turned) / distance(before) - 1) < 0.02, `${tab}: one finger turns`);
        assert.ok(Math.hypot(turned[0] - before[0], turned[1] - before[1]) > 0.1 * distance(before), `${tab}: ${before} to ${turned}`);
      }, PHONE);
    }
  }],

  ['curves: pinch zooms about the fingers, two fingers move; a finger drags a point and draws', () => withPage([], 'Curves', async ({view, page, bar}) => {
    const svg = page.locator('svg.curves'), {x, y, left, width} = await middle(svg);
    await view.picture('phone-curves');
    const span = async () => { const {window: box} = (await state(view)).curves; return box[2] - box[0]; };
    await fingers(view, [[x - 40, y], [x + 40, y]], [[x - 80, y], [x + 80, y]]);
    const near = await span();
    await fingers(view, [[x - 80, y], [x + 80, y]], [[x - 40, y], [x + 40, y]]);
    const far = await span();
    assert.ok(Math.abs(far / near - 2) < 0.05, `twice as far apart is half as much to see: ${near}, ${far}`);
    const box = (await state(view)).curves.window;
    await fingers(view, [[x - 40, y], [x + 40, y]], [[x + 10, y + 30], [x + 90, y + 30]]);
    const moved = (await state(view)).curves.window, unit = (box[2] - box[0]) / width;
    assert.ok(Math.abs((box[0] - moved[0]) / unit - 50) < 3, `moved by 50 pixels: ${(box[0] - moved[0]) / unit}`);
    assert.ok(Math.abs(moved[2] - moved[0] - (box[2] - box[0])) < 1e-3 * (box[2] - box[0]), 'and did not zoom');
    // One finger on a point drags it.
    const count = await page.locator('circle.point').count(), point = await middle(page.locator('circle.point').nth(1));
    await fingers(view, [[point.x, point.y]], [[point.x + 30, point.y - 20]]);
    const after = await middle(page.locator('circle.point').nth(1));
    assert.ok(Math.hypot(after.x - point.x - 30, after.y - point.y + 20) < 2, 'the point lies under the finger');
    // Drawing: a tap adds a point, a pinch does not.
    await bar.getByLabel('New curve').selectOption('spline');
    await view.quiet();
    await svg.scrollIntoViewIfNeeded();
    const own = await page.locator('circle.point').count(), place = await middle(svg);
    await fingers(view, [[place.x - 40, place.y], [place.x + 40, place.y]], [[place.x - 60, place.y], [place.x + 60, place.y]]);
    assert.equal(await page.locator('circle.point').count(), own, 'a pinch draws nothing');
    await fingers(view, [[place.left + 60, place.y + 60]], [[place.left + 60, place.y + 60]], 1);
    assert.equal(await page.locator('circle.point').count(), own + 1, 'a tap draws');
    assert.ok(count > 2);
  }, PHONE)],

  ['a triangular surface: a finger drags a control point, and the page does not scroll', () => withPage([], 'Triangular surfaces', async ({view, page}) => {
    const canvas = page.locator('.patch-stage:not(.tetra-stage) canvas');
    const places = async () => JSON.parse(await canvas.getAttribute('data-handles'));
    const [x, y] = (await places())[1], scroll = await page.evaluate(() => document.scrollingElement.scrollTop);
    await fingers(view, [[x + 6, y - 5]], [[x + 46, y - 45]]);
    const [moved] = [(await places())[1]];
    assert.ok(Math.hypot(moved[0] - x - 40, moved[1] - y + 40) < 12, `from ${[x, y]} to ${moved}`);
    assert.equal(await page.evaluate(() => document.scrollingElement.scrollTop), scroll);
  }, PHONE)],
];
