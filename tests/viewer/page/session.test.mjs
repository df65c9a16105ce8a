// The printed address opens the page once; what belongs to the same user goes on: a reload, a duplicate, "New tab".
import assert from 'node:assert/strict';
import {View} from './support.mjs';

const LOADED = '.status[data-busy="false"]';

async function failure(page) {
  await page.waitForSelector('main.failure[role=alert]');
  return page.textContent('main.failure');
}

export const tests = [
  ['a program that has ended is said in words, where one looks for them', async () => {
    const view = await View.open([]), {page} = view;
    try {
      await view.go();
      await page.getByRole('tab', {name: 'Curves'}).click();
      await view.quiet();
      view.server.removeAllListeners('exit');
      const ended = new Promise((resolve) => view.server.on('exit', resolve));
      view.server.kill('SIGINT');
      assert.equal(await ended, 0);
      await page.getByLabel('Curvature comb').check();
      await page.waitForSelector('.status.error');
      assert.match(await page.textContent('.status.error'), /has ended, or was stopped. Run `retalho view` again/);
      assert.equal(await page.locator('path.curve').count(), 1, 'what was drawn stays');
    } finally {
      await view.context.close();
    }
  }],

  ['without WebGL the views that need it say so, and curves are drawn', async () => {
    const view = await View.open([]), {page} = view;
    try {
      await page.addInitScript(() => {
        const original = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind.startsWith('webgl') ? null : original.call(this, kind, ...more); };
      });
      await view.go();
      for (const tab of ['Terrain', 'Triangular surfaces', 'TetraQuads']) {
        await page.getByRole('tab', {name: tab}).click();
        const words = page.locator('main .failure:not([hidden])');
        assert.equal(await words.count(), 1, tab);
        assert.match(await words.textContent(), /no WebGL 2/);
      }
      await page.getByRole('tab', {name: 'Curves'}).click();
      await view.quiet();
      assert.equal(await page.locator('main .failure:not([hidden])').count(), 0);
      assert.equal(await page.locator('path.curve').count(), 1);
    } finally {
      assert.equal(await view.close(), 0);
    }
  }],

  ['the address works once: another browser is refused in words, reload and the same tab go on, "New tab" opens another', async () => {
    const view = await View.open([]), other = await View.open([]);
    try {
      await view.go();
      assert.ok(!view.page.url().includes('token'), view.page.url());
      // Another party: a browser of its own with the same address.
      await other.page.goto(view.address);
      assert.match(await failure(other.page), /used already/);
      assert.equal(await other.page.evaluate(() => sessionStorage.length), 0, 'it has learnt no secret');
      // The user: a reload, and the same address once more in the same tab.
      await view.page.reload();
      await view.quiet();
      await view.page.goto('about:blank');
      await view.page.goto(view.address);
      await view.quiet();
      // A second tab by the printed address is refused; by the button it opens, and reloads.
      const second = await view.context.newPage();
      await second.goto(view.address);
      assert.match(await failure(second), /"New tab"/);
      await second.close();
      const opening = view.context.waitForEvent('page');
      await view.page.getByRole('button', {name: 'New tab'}).click();
      const tab = await opening;
      await tab.waitForSelector(LOADED);
      assert.ok(!tab.url().includes('token'), tab.url());
      await tab.reload();
      await tab.waitForSelector(LOADED);
      await view.page.reload();
      await view.quiet();
    } finally {
      await other.close();
      assert.equal(await view.close(), 0);
    }
  }],
];
