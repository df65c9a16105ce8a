// The unit tests of the page's own code: each NAME.test.ts is bundled and run by node's own test runner.
import {spawnSync} from 'node:child_process';
import {existsSync, mkdtempSync, readdirSync, rmSync} from 'node:fs';
import {join} from 'node:path';
import {tmpdir} from 'node:os';
import {fileURLToPath} from 'node:url';

const here = fileURLToPath(new URL('.', import.meta.url));
if (!existsSync(join(here, '../node_modules/esbuild'))) {
  console.log('skipped: the page\'s packages are not installed (scripts/page installs them)');
  process.exit(77);
}
const {buildSync} = await import('esbuild');
const out = mkdtempSync(join(tmpdir(), 'retalho-units-'));
const tests = readdirSync(here).filter((name) => name.endsWith('.test.ts'));
buildSync({entryPoints: tests.map((name) => join(here, name)), bundle: true, platform: 'node', format: 'esm', outdir: out, outExtension: {'.js': '.mjs'}, logLevel: 'warning', loader: {'.css': 'empty'}});
const done = spawnSync(process.execPath, ['--test', ...tests.map((name) => join(out, name.replace(/\.ts$/, '.mjs')))], {stdio: 'inherit'});
rmSync(out, {recursive: true});
process.exit(done.status ?? 1);
