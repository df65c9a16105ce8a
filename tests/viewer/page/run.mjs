// The page's tests in Debian's chromium (WebGL 2 in software), each view in a file of its own: open, click, drag, read
// the numbers and compare them with the program's own answers. Pictures of every view are left in $RETALHO_PICTURES
// (default build/page-pictures). Exit code 77 where there is no browser.
//
//   node tests/viewer/page/run.mjs [NAME...]
import {execFileSync} from 'node:child_process';
import {existsSync, readdirSync} from 'node:fs';
import {fileURLToPath} from 'node:url';
import {chromiumDriver, findChromium, pictures, program, skip} from './support.mjs';

if (!findChromium()) skip('chromium is not installed (scripts/setup installs it)');
if (!existsSync(program)) throw new Error(`the program is not built: ${program}`);
chromiumDriver();
try {
  execFileSync(program, ['view', '--no-browser', '/nowhere/at-all'], {stdio: 'pipe'});
} catch (error) {
  if (String(error.stderr).includes('without the page')) skip('the program was built without the page (scripts/page)');
}

const here = fileURLToPath(new URL('.', import.meta.url));
const wanted = process.argv.slice(2);
let passed = 0;
const failed = [];
for (const name of readdirSync(here).filter((file) => file.endsWith('.test.mjs')).sort()) {
  if (wanted.length > 0 && !wanted.some((word) => name.includes(word))) continue;
  const {tests} = await import(`./${name}`);
  for (const [words, run] of tests) {
    const begun = Date.now();
    try {
      await run();
      ++passed;
      console.log(`ok ${name}: ${words} (${Date.now() - begun} ms)`);
    } catch (error) {
      failed.push(words);
      console.log(`FAILED ${name}: ${words}\n${error.stack ?? error}`);
    }
  }
}
console.log(`${passed} passed, ${failed.length} failed; pictures are in ${pictures}`);
process.exit(failed.length > 0 || passed === 0 ? 1 : 0);
