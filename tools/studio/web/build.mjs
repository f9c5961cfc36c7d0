// Bundles the page: node build.mjs OUT_DIR [--watch]. The names of scripts and styles hold their hash, so that browsers may keep them for ever.
import { createHash } from 'node:crypto';
import { mkdir, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateSync } from 'node:zlib';
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

// The same page as one file, for a run whose data are written into it: nothing is loaded, and nothing else may run.
const source = (kind) => result.outputFiles.find((file) => file.path.endsWith(`.${kind}`)).contents;
const style = new TextDecoder().decode(source('css')).replaceAll('</style', '<\\/style');
const viewer = deflateSync(source('js'), { level: 9 }).toString('base64');
const loader = (await readFile(join(here, 'src/run_loader.js'), 'utf8')).trim();
const hash_of = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const policy = `default-src 'none'; script-src blob: ${hash_of(loader)}; style-src ${hash_of(style)}; img-src blob: data:; connect-src blob: data:; worker-src blob:; base-uri 'none'; form-action 'none'`;
const head = page
  .replace('<meta charset="utf-8">', () => `<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="${policy}">`)
  .replace('<link rel="stylesheet" href="assets/studio.css">', () => `<style>${style}</style>`)
  .replace('<script type="module" src="assets/studio.js"></script>', '');
await writeFile(join(out, 'run.html'), head.replace('</body>', () => `<!--run-->\n<script type="text/plain" id="run-viewer">${viewer}</script>\n<script>${loader}</script>\n</body>`));
