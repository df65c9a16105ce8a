// The pictures of the page in README.md and docs/viewer.md, from the page itself (scripts/page and a build come first):
//
//   node tests/viewer/page/pictures.mjs            all of them, into docs/images/viewer
//   node tests/viewer/page/pictures.mjs terrain    one
import {mkdirSync} from 'node:fs';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {View} from './support.mjs';

const root = fileURLToPath(new URL('../../../', import.meta.url)), folder = join(root, 'docs/images/viewer');
const example = (name) => join(root, 'examples', name);

async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, {steps: 10});
  await page.mouse.up();
}

async function wheel(page, turns) {
  for (let k = 0; k < Math.abs(turns); ++k) await page.mouse.wheel(0, 120 * Math.sign(turns));
}

/** name: [files, tab, what is done before the picture]. */
const PICTURES = {
  start: [[], 'Start', async () => undefined],
  terrain: [[example('jacksboro.vrt')], 'Terrain', async ({page, view, bar}) => {
    await bar.getByLabel('Side by side').selectOption('3');
    await view.quiet();
    await bar.getByLabel('Vertical exaggeration of the picture').last().fill('2');
    await page.keyboard.press('Enter');
    await bar.getByLabel('Fineness by').selectOption('vertices');
    await bar.getByLabel('Vertices').last().fill('1200');
    await page.keyboard.press('Enter');
    await view.quiet();
    await page.mouse.move(460, 400);
    await wheel(page, -1);
    await bar.evaluate((element) => { element.parentElement.scrollTop = 0; });
  }],
  contours: [[example('jacksboro.vrt')], 'Terrain', async ({page, view, bar}) => {
    await bar.getByLabel('Fit').selectOption('surface');
    await bar.getByLabel('Tolerance').last().fill('25');
    await page.keyboard.press('Enter');
    await bar.getByLabel('Vertical exaggeration of the picture').last().fill('2');
    await page.keyboard.press('Enter');
    await bar.getByLabel('Contours').check();
    await bar.getByLabel('Interval').last().fill('50');
    await page.keyboard.press('Enter');
    await view.quiet();
    await page.mouse.move(790, 420);
    await wheel(page, -5);
    await view.quiet();
    await bar.getByRole('button', {name: 'Profile'}).click();
    await page.mouse.click(640, 560);
    await page.mouse.click(940, 330);
    await view.quiet();
  }],
  viewshed: [[example('jacksboro.vrt')], 'Terrain', async ({page, view, bar}) => {
    await bar.getByLabel('Vertical exaggeration of the picture').last().fill('2');
    await page.keyboard.press('Enter');
    await view.quiet();
    await page.mouse.move(790, 420);
    await wheel(page, -5);
    await bar.getByRole('button', {name: 'Viewshed'}).click();
    await bar.getByLabel('Eye over ground').last().fill('30');
    await page.keyboard.press('Enter');
    await page.mouse.click(790, 430);
    await view.quiet();
  }],
  curves: [[], 'Curves', async ({view, bar}) => {
    await bar.getByLabel('Example').selectOption({label: 'B-spline'});
    await bar.getByLabel('Curvature comb').check();
    await bar.getByLabel('Hodograph').check();
    await view.quiet();
  }],
  patches: [[], 'Triangular surfaces', async ({page, view, bar}) => {
    await bar.getByLabel('Surface shown').selectOption({label: 'Example: Hull'});
    await bar.getByLabel('Colour').selectOption('zebra');
    await view.quiet();
    await page.mouse.move(800, 400);
    await wheel(page, -2);
  }],
  tetraquads: [[], 'TetraQuads', async ({view, bar}) => {
    await bar.getByLabel('Surface', {exact: true}).selectOption({label: 'Example: Normals that jump'});
    await bar.getByLabel('Tetrahedra on the surface').check();
    await view.quiet();
  }],
};

mkdirSync(folder, {recursive: true});
for (const [name, [files, tab, run]] of Object.entries(PICTURES)) {
  if (process.argv.length > 2 && !process.argv.slice(2).includes(name)) continue;
  const view = await View.open(files), {page} = view;
  try {
    await view.go();
    await page.getByRole('tab', {name: tab}).click();
    await view.quiet();
    await run({page, view, drag, bar: page.locator('.controls:not([hidden])')});
    await page.mouse.move(5, 300);  // nothing is hovered over
    await view.quiet();
    await page.screenshot({path: join(folder, `${name}.png`)});
    console.log(`${name}.png`);
    if (view.problems.length > 0) throw new Error(view.problems.join('\n'));
  } finally {
    await view.close();
  }
}
process.exit(0);
