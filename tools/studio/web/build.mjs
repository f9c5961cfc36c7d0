// Bundles the page: node build.mjs OUT_DIR [--watch]. The names of scripts and styles hold their hash, so that browsers may keep them for ever.
import { createHash } from 'node:crypto';
import { mkdir, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'dist');

const result = await build({
  absWorkingDir: here,
  entryPoints: ['src/main.ts', 'src/style.css'],
  bundle: true,
  minify: true,
  format: 'esm',
  target: ['es2022'],
  legalComments: 'none',
  write: false,
  outdir: 'out',
  loader: { '.svg': 'text' },
});

await mkdir(join(out, 'assets'), { recursive: true });
for (const old of await readdir(join(out, 'assets'))) await rm(join(out, 'assets', old));
const names = {};
for (const file of result.outputFiles) {
  const kind = file.path.endsWith('.css') ? 'css' : 'js';
  const hash = createHash('sha256').update(file.contents).digest('hex').slice(0, 10);
  names[kind] = `studio-${hash}.${kind}`;
  await writeFile(join(out, 'assets', names[kind]), file.contents);
}
const page = await readFile(join(here, 'src/index.html'), 'utf8');
await writeFile(join(out, 'index.html'), page.replace('studio.js', names.js).replace('studio.css', names.css));
