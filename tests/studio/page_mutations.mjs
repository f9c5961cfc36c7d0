// Mutated data blocks of a page that rtse wrote, against the reader of the page (run_data.ts) without a browser: each request is answered or
// rejected with a reason, and nothing fails elsewhere. page_mutations.mjs PAGE_HTML WEB_FOLDER [NUMBER [SEED]]; WEB_FOLDER has src and node_modules.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { deflateSync, inflateSync } from 'node:zlib';

export function random(seed) {
  let state = seed >>> 0;
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t ^= t + Math.imul(t ^ (t >>> 7), 61 | t);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  return { below: (n) => Math.floor(next() * n), of: (list) => list[Math.floor(next() * list.length)] };
}

export function blocks_of(html) {
  return new Map([...html.matchAll(/<script type="text\/plain" id="run-([^"]+)">([^<]*)<\/script>/g)].map(([, id, text]) => [id, text]).filter(([id]) => id !== 'viewer'));
}

// What the blocks hold, but for the worlds.
export const json_of = (blocks) => new Map([...blocks].filter(([id]) => !['world', 'collisions'].includes(id)).map(([id, text]) => [id, JSON.parse(inflateSync(Buffer.from(text, 'base64')).toString())]));

const odd = [null, -1, 0, 1e308, '', 'x', [], {}, true, '__proto__', [[]], [null], NaN, { length: 1e9 }];

// Another value at a random place of a JSON value.
function other_value(value, pick, depth = 0) {
  if (depth > 12 || value === null || typeof value !== 'object' || pick.below(6) === 0) return pick.of(odd);
  const keys = Object.keys(value);
  if (keys.length === 0) return pick.of(odd);
  const key = pick.of(keys);
  const copy = Array.isArray(value) ? value.slice() : { ...value };
  if (pick.below(10) === 0) delete copy[key];
  else copy[key] = other_value(value[key], pick, depth + 1);
  return copy;
}

function frozen(value) {
  if (value !== null && typeof value === 'object') for (const one of Object.values(Object.freeze(value))) frozen(one);
  return value;
}

const pack = (value) => deflateSync(JSON.stringify(value) ?? 'null', { level: 1 }).toString('base64');

// Text that is no longer that of the block; `json`: what it holds.
export function mutated(text, json, pick) {
  const at = pick.below(text.length), letters = 'ABCxyz019+/=<>&"\' \n';
  switch (pick.below(json === undefined ? 5 : 9)) {
    case 0: return text.slice(0, at);
    case 1: return text.slice(0, at) + pick.of([...letters]) + text.slice(at + 1);
    case 2: return text.slice(0, at) + text.slice(at + 1 + pick.below(40));
    case 3: return text.slice(0, at) + text.slice(at, at + pick.below(400)) + text.slice(at);
    case 4: {
      const octets = Buffer.from(text, 'base64');
      octets[pick.below(octets.length)] ^= 1 << pick.below(8);
      return octets.toString('base64');
    }
    default: return pack(other_value(json, pick));
  }
}

// The reader of the page. Blocks whose text is that of the page itself are unpacked once, and nobody may change what they hold; all others
// take the way of the page.
async function reader(web, whole) {
  const require = createRequire(resolve(web, 'package.json'));
  const { build } = require('esbuild');
  const real = resolve(web, 'src/run_blocks.ts');
  globalThis.kept_block = { is_whole: (id) => whole(id) === document.getElementById(`run-${id}`)?.textContent, frozen };
  const keeping = `export { from_base64 } from '${real}';
    import { json_of as fresh } from '${real}';
    const kept = new Map();
    export async function json_of(id) {
      if (!kept_block.is_whole(id)) return fresh(id);
      if (!kept.has(id)) kept.set(id, kept_block.frozen(await fresh(id)));
      return kept.get(id);
    }`;
  const keep = {
    name: 'keep',
    setup: (building) => {
      building.onResolve({ filter: /\/run_blocks$/ }, () => ({ path: 'keeping', namespace: 'keep' }));
      building.onLoad({ filter: /.*/, namespace: 'keep' }, () => ({ contents: keeping, resolveDir: web }));
    },
  };
  const entry = { contents: `export { RunData } from './src/run_data'; export { fetch_run } from '${real}';`, resolveDir: resolve(web), sourcefile: 'entry.js' };
  const { outputFiles } = await build({ stdin: entry, bundle: true, format: 'esm', write: false, logLevel: 'error', plugins: [keep] });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
}

// A request is lost if it waits when the process has nothing left to do.
const waiting = new Map();

function answered(what, promise) {
  const lost = new Promise((_, reject) => waiting.set(promise, () => reject(new Error(`${what} is not answered`))));
  return Promise.race([promise, lost]).finally(() => waiting.delete(promise));
}

// Replaces that of node, whose threads delay this one on a busy machine.
class Inflating extends TransformStream {
  constructor() {
    const chunks = [];
    super({ transform: (chunk) => { chunks.push(chunk); }, flush: (out) => out.enqueue(new Uint8Array(inflateSync(Buffer.concat(chunks)))) });
  }
}

// Opens the page and asks for everything once that needs this block. Returns whether anything was said about it.
async function use(RunData, fetch_run, asked, block) {
  const replies = new Map();
  let events = 0, rejected = 0, damage = 0;
  const take = (data) => {
    events += 1;
    if (typeof data !== 'string') return;
    const event = JSON.parse(data);
    if (event?.op !== 'reply') return;
    if (event.error !== undefined && !event.error) throw new Error('an error without words');
    rejected += event.error !== undefined ? 1 : 0;
    replies.get(event.id)?.();
  };
  const run = await answered('open', RunData.open(take, (why) => { if (!why) throw new Error('damage without words'); damage += 1; }));
  run.begin();
  const needs_world = block === 'world' || block === 'collisions';
  const requests = asked.filter(([name]) => !needs_world && (name === 'component') === (block === 'parameters')).map(([name, args], id) => {
    const reply = new Promise((resolve) => replies.set(id, resolve));
    run.send(JSON.stringify({ op: 'request', id, name, args }));
    return answered(`${name} ${JSON.stringify(args)}`, reply);
  });
  await Promise.all(requests);
  if (needs_world) await answered('world', fetch_run(`world.glb${block === 'collisions' ? '?collisions=1' : ''}`).catch((error) => { if (!error.message) throw error; rejected += 1; }));
  return rejected + damage > 0;
}

async function main([html_file, web, number = '3000', seed = '1']) {
  const blocks = blocks_of(readFileSync(html_file, 'utf8'));
  const json = json_of(blocks);
  const index = json.get('index');
  const shown = new Map(blocks);
  globalThis.DecompressionStream = Inflating;
  globalThis.WebSocket ??= class {};
  globalThis.WebSocket.OPEN ??= 1;
  globalThis.document = { getElementById: (id) => (shown.has(id.slice(4)) ? { textContent: shown.get(id.slice(4)) } : null) };
  const { RunData, fetch_run } = await reader(web, (id) => blocks.get(id));
  const topics = index.signals.signals.map((signal) => signal.topic);
  const { from, to } = index.hello.recording;
  const asked = [
    ['look', { time: from, whole: true }], ['look', { time: (from + to) / 2 }], ['look', { time: to }], ['look', { time: from }],
    ['watch', { watch: 1, topic: topics[0] }], ['watch', { watch: 2, topic: topics[1], members: ['data.vx', 'ranges[3]'] }], ['look', { time: to }],
    ['series', { topic: topics[0], members: ['data.vx'] }], ['series', { topic: topics[1], members: ['ranges[3]'], other: true }],
    ...index.system.components.slice(0, 1).map((one) => ['component', { path: one.path }]), ['watch_image', { watch: 3, iface: 'x' }]];
  let unhandled;
  process.on('beforeExit', () => waiting.forEach((lose) => lose()));
  process.on('unhandledRejection', (error) => { unhandled = error; });
  for (const id of blocks.keys()) if (await use(RunData, fetch_run, asked, id)) throw new Error('the page itself is not whole');
  const pick = random(Number(seed)), ids = [...blocks.keys()];
  let refused = 0, said = 0;
  for (let i = 0; i < Number(number); ++i) {
    const id = pick.of(ids);
    shown.set(id, mutated(blocks.get(id), json.get(id), pick));
    try {
      said += (await use(RunData, fetch_run, asked, id)) ? 1 : 0;
    } catch (error) {
      refused += 1;
      if (!(error instanceof Error) || !error.message || /is not answered/.test(error.message)) throw new Error(`page ${i}, block ${id}: ${error}`);
    }
    if (unhandled) throw new Error(`page ${i}, block ${id}: nobody has taken: ${unhandled.stack ?? unhandled}`);
    shown.set(id, blocks.get(id));
    if (process.env.STUDIO_LOGS && (i + 1) % 1000 === 0) console.log(i + 1, refused, said);
  }
  console.log(`${number} pages: ${refused} not opened, ${said} opened with a message, ${number - refused - said} without`);
}

if (process.argv[1]?.endsWith('page_mutations.mjs')) await main(process.argv.slice(2));
