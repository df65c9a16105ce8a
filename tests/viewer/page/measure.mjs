// Figures of the page, printed and never asserted; the last line is {"value": number}.
//
//   node tests/viewer/page/measure.mjs first-picture   seconds from the start of `retalho view` on 1,201 x 1,201 cells to the
//                                                      first picture in Chromium (software WebGL; the browser runs already)
//   node tests/viewer/page/measure.mjs drag            milliseconds of computing a frame while a side is dragged at n = 64,
//                                                      the median of 200
//   node tests/viewer/page/measure.mjs stall           milliseconds that the page's longest task took while a fractal terrain of
//                                                      3,600 x 3,600 cells was opened, turned and zoomed into; prints the
//                                                      longest pause between two frames as well (software WebGL draws on
//                                                      the same processors)
import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {chromiumDriver, findChromium, program, writeFractal, writeHills} from './support.mjs';

function serve(args) {
  const server = spawn(program, ['view', '--no-browser', '--json', '--quiet', ...args], {stdio: ['ignore', 'pipe', 'inherit']});
  return new Promise((resolve) => {
    let text = '';
    server.stdout.on('data', (data) => {
      text += data;
      if (text.includes('}')) resolve({server, address: JSON.parse(text).address});
    });
  });
}

function browser(folder) {
  return chromiumDriver().launchPersistentContext(join(folder, 'profile'), {executablePath: findChromium(), headless: true, viewport: {width: 1280, height: 800},
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage']});
}

async function firstPicture() {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-measure-'));
  const dem = join(folder, 'hills.asc');
  writeHills(dem, 1201, 1201);
  const context = await browser(folder);
  const page = await context.newPage();
  const begun = performance.now();
  const {server, address} = await serve([dem]);
  await page.goto(address);
  await page.waitForSelector('.stage .overlay dl dd');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const seconds = (performance.now() - begun) / 1000;
  await context.close();
  server.kill('SIGINT');
  rmSync(folder, {recursive: true, force: true});
  return seconds;
}

async function stall() {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-measure-'));
  const dem = join(folder, 'fractal.pgm');
  writeFractal(dem, 3600, 3600);
  const context = await browser(folder);
  const page = await context.newPage();
  // From the page's first line on: tasks of over 50 ms, as the browser itself counts them, and the pauses between frames.
  await page.addInitScript(() => {
    window.longest = {task: 0, pause: 0, frames: 0};
    new PerformanceObserver((list) => { for (const entry of list.getEntries()) window.longest.task = Math.max(window.longest.task, entry.duration); }).observe({type: 'longtask', buffered: true});
    let before = performance.now();
    const frame = (now) => {
      window.longest.pause = Math.max(window.longest.pause, now - before);
      window.longest.frames += 1;
      before = now;
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  const take = async (words) => {
    const {task, pause, frames} = await page.evaluate(() => { const was = {...window.longest}; window.longest.task = window.longest.pause = window.longest.frames = 0; return was; });
    console.log(`${words}: longest task ${task > 0 ? `${task.toFixed(0)} ms` : 'under 50 ms'}, longest pause between frames ${pause.toFixed(0)} ms, ${frames} frames`);
    return task;
  };
  const quiet = () => page.waitForSelector('.status[data-busy="false"]', {timeout: 120_000});
  const {server, address} = await serve([dem]);
  const begun = performance.now();
  await page.goto(address);
  await page.waitForSelector('.stage .overlay dl dd', {timeout: 120_000});
  await quiet();
  console.log(`open after ${((performance.now() - begun) / 1000).toFixed(1)} s: ${(await page.textContent('.stage .overlay dl')).replace(/\s+/g, ' ')}`);
  const tasks = [await take('opening')];
  await page.mouse.move(760, 400);
  await page.mouse.down();
  for (let k = 0; k < 60; ++k) await page.mouse.move(760 + 4 * k, 400 - k);
  await page.mouse.up();
  await quiet();
  tasks.push(await take('turning'));
  for (let k = 0; k < 24; ++k) {
    await page.mouse.wheel(0, -240);
    await page.waitForTimeout(60);
  }
  await quiet();
  console.log(`near: ${await page.locator('.stage .overlay').getAttribute('data-detail')}`);
  tasks.push(await take('zooming'));
  await page.mouse.move(760, 500);
  await page.mouse.down();
  for (let k = 0; k < 60; ++k) await page.mouse.move(760 - 4 * k, 500 - 2 * k);
  await page.mouse.up();
  await quiet();
  tasks.push(await take('turning near'));
  await context.close();
  server.kill('SIGINT');
  rmSync(folder, {recursive: true, force: true});
  return Math.max(...tasks);
}

async function drag() {
  const {server, address} = await serve([]);
  const {origin, hash} = new URL(address);
  const document = JSON.parse(readFileSync(fileURLToPath(new URL('../../../examples/patches/saddle.json', import.meta.url)), 'utf8'));
  const json = {'Content-Type': 'application/json'};
  const {session} = await (await fetch(origin + '/api/session', {method: 'POST', headers: {...json, 'X-Retalho-Token': hash.slice('#token='.length)}, body: '{}'})).json();
  const times = [];
  for (let k = 0; k < 210; ++k) {
    document.patches[0].sides[0].points[1][2] = 0.55 + 0.3 * Math.sin(k / 20);
    const response = await fetch(origin + '/api/patches/compute', {method: 'POST', headers: {...json, 'X-Retalho-Session': session},
      body: JSON.stringify({document, divisions: 64, recovery: 'smooth', colour: 'none', dragging: true})});
    const bytes = Buffer.from(await response.arrayBuffer());
    const header = JSON.parse(bytes.subarray(8, 8 + bytes.readUInt32LE(4)).toString());
    if (k >= 10) times.push(1000 * header.words.seconds);
  }
  server.kill('SIGINT');
  times.sort((a, b) => a - b);
  console.log(`median ${times[100].toFixed(2)} ms, worst ${times[199].toFixed(2)} ms`);
  return times[100];
}

const what = {'first-picture': firstPicture, drag, stall}[process.argv[2]];
if (!what) throw new Error('say first-picture, drag or stall');
console.log(JSON.stringify({value: await what()}));
process.exit(0);
