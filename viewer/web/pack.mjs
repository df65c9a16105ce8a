// After `vite build`: each file of the page as gzip bytes beside it, for embed_page.cmake, and the page's size against
// its limit of 1 MB.
import {readdirSync, readFileSync, statSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';

const folder = fileURLToPath(new URL('../../build/web', import.meta.url));
const limit = 1_000_000;
let total = 0;
for (const name of readdirSync(folder)) {
  const file = join(folder, name);
  if (name.endsWith('.gz') || !statSync(file).isFile()) continue;
  const packed = gzipSync(readFileSync(file), {level: 9});
  writeFileSync(file + '.gz', packed);
  total += packed.length;
}
console.log(`page: ${total} bytes compressed (limit ${limit})`);
if (total > limit) {
  console.error('page: over the limit');
  process.exit(1);
}
