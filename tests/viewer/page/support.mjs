// Runs the program and a browser for the page's tests, as a person would: the printed address, Debian's chromium.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';

const root = fileURLToPath(new URL('../../../', import.meta.url));
const require = createRequire(join(root, 'viewer/web/package.json'));

export const program = process.env.RETALHO_PROGRAM ?? join(root, 'build/release/retalho');
export const pictures = process.env.RETALHO_PICTURES ?? join(root, 'build/page-pictures');
export const SKIP = 77;  // what ctest takes for "skipped"

export function findChromium() {
  return ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
}

export function skip(words) {
  console.log(`skipped: ${words}`);
  process.exit(SKIP);
}

export function chromiumDriver() {
  try {
    return require('playwright-core').chromium;
  } catch {
    return skip('playwright-core is not installed (scripts/page installs it)');
  }
}

/** The program's own answer, as JSON. */
export function retalho(...args) {
  return JSON.parse(execFileSync(program, [...args, '--json', '--quiet'], {encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit']}));
}

/** Smooth hills of integer heights on an ASCII grid, cells of 10 with the lower left corner at (1000, 2000). */
export function writeHills(path, columns, rows) {
  let text = `ncols ${columns}\nnrows ${rows}\nxllcorner 1000\nyllcorner 2000\ncellsize 10\n`;
  for (let r = 0; r < rows; ++r) {
    text += Array.from({length: columns}, (_, c) => Math.round(400 + 90 * Math.sin(c * 0.07) * Math.cos(r * 0.05) + 55 * Math.sin(c * 0.021 + r * 0.033) - 80 * Math.exp(-(((r - 0.4 * c - 30) / 7) ** 2)))).join(' ') + '\n';
  }
  writeFileSync(path, text);
}

/** A fractal terrain (octaves of noise between the points of ever finer lattices) as a PGM of 16 bits. */
export function writeFractal(path, columns, rows) {
  const heights = new Float64Array(columns * rows);
  let seed = 12345;
  const random = () => ((seed = (Math.imul(seed, 1103515245) + 12345) >>> 0) / 2 ** 32);
  for (let period = 1024, size = 1; period >= 4; period /= 2, size *= 0.48) {
    const across = Math.ceil(columns / period) + 2, lattice = Float64Array.from({length: across * (Math.ceil(rows / period) + 2)}, random);
    const smooth = Float64Array.from({length: period}, (_, k) => { const t = k / period; return t * t * (3 - 2 * t); });
    for (let r = 0; r < rows; ++r) {
      const y = Math.floor(r / period) * across, v = smooth[r % period];
      for (let c = 0; c < columns; ++c) {
        const at = y + Math.floor(c / period), u = smooth[c % period];
        const upper = lattice[at] + u * (lattice[at + 1] - lattice[at]), lower = lattice[at + across] + u * (lattice[at + across + 1] - lattice[at + across]);
        heights[r * columns + c] += size * (upper + v * (lower - upper));
      }
    }
  }
  const bytes = Buffer.alloc(2 * heights.length);
  heights.forEach((h, k) => bytes.writeUInt16BE(Math.round(600 * h), 2 * k));
  writeFileSync(path, Buffer.concat([Buffer.from(`P5\n${columns} ${rows}\n65535\n`), bytes]));
}

/** Points with normals on an ellipsoid of half axes 1.4, 1 and 0.8, along a spiral. */
export function writeEgg(path, count) {
  let text = 'x,y,z,nx,ny,nz\n';
  for (let k = 0; k < count; ++k) {
    const z = 1 - (2 * k + 1) / count, r = Math.sqrt(1 - z * z), a = k * 2.399963;
    const [x, y] = [r * Math.cos(a), r * Math.sin(a)];
    text += [1.4 * x, y, 0.8 * z, x / 1.4, y, z / 0.8].map((v) => v.toFixed(7)).join(',') + '\n';
  }
  writeFileSync(path, text);
}

export class View {
  /** `shape`: another size of the window, or fingers (hasTouch). */
  static async open(args, shape = {}) {
    const view = new View();
    view.folder = mkdtempSync(join(tmpdir(), 'retalho-page-'));
    mkdirSync(pictures, {recursive: true});
    view.server = spawn(program, ['view', '--no-browser', '--json', '--quiet', ...args], {stdio: ['ignore', 'pipe', 'inherit']});
    view.address = await new Promise((resolve, reject) => {
      let text = '';
      view.server.stdout.on('data', (data) => {
        text += data;
        if (text.includes('}')) resolve(JSON.parse(text).address);
      });
      view.server.on('exit', (code) => reject(new Error(`the program ended with code ${code}`)));
    });
    // A profile of its own in a folder of its own: nothing is shared with the user's browser.
    view.context = await chromiumDriver().launchPersistentContext(join(view.folder, 'profile'), {
      executablePath: findChromium(),
      headless: true,
      viewport: {width: 1280, height: 800},
      ...shape,
      args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'],
    });
    view.page = view.context.pages()[0] ?? await view.context.newPage();
    view.problems = [];
    view.requests = [];
    view.page.on('console', (message) => { if (message.type() === 'error') view.problems.push(message.text()); });
    view.page.on('pageerror', (error) => view.problems.push(String(error)));
    view.page.on('request', (request) => view.requests.push(request.url()));
    return view;
  }

  async go() {
    await this.page.goto(this.address);
    await this.quiet();
  }

  /** Waits until nothing runs and the picture has been drawn. */
  async quiet() {
    // By selector: the page's security policy forbids the evaluation of strings that waitForFunction needs.
    await this.page.waitForSelector('.status[data-busy="false"]', {timeout: 60_000});
    await this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }

  async picture(name) {
    await this.page.screenshot({path: join(pictures, `${name}.png`)});
  }

  async close() {
    await this.context?.close();
    this.server.removeAllListeners('exit');
    const ended = new Promise((resolve) => this.server.on('exit', resolve));
    this.server.kill('SIGINT');
    const code = await ended;
    rmSync(this.folder, {recursive: true, force: true});
    return code;
  }
}

/** Opens the page at one of its tabs, runs `run({view, page, folder, bar})`, and closes all; no error of the browser. */
export async function withPage(files, tab, run, shape = {}) {
  const folder = mkdtempSync(join(tmpdir(), 'retalho-page-test-'));
  const view = await View.open(files, shape);
  try {
    await view.go();
    await view.page.getByRole('tab', {name: tab}).click();
    await view.quiet();
    await run({view, page: view.page, folder, bar: view.page.locator('.controls:not([hidden])')});
    assert.deepEqual(view.problems, [], 'the browser reports no error');
  } finally {
    assert.equal(await view.close(), 0);
    rmSync(folder, {recursive: true});
  }
}

/** A list of terms and values as an object, with plain minus signs. */
export const listed = (box) => box.evaluate((element) => Object.fromEntries([...element.querySelectorAll('dt')].map((dt) => [dt.textContent, dt.nextElementSibling.textContent.replaceAll('−', '-')])));
