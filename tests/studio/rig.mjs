// What all flows share: a browser, processes with ports and ids of their own, and waiting for conditions. Everything that was started has
// ended when a run is over.
import { spawn, execFile } from 'node:child_process';
import { createSocket } from 'node:dgram';
import { existsSync, mkdtempSync, openSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { promisify } from 'node:util';

export const watchdog = Number(process.env.STUDIO_WATCHDOG ?? 180000); // [ms]; a bound on hanging, not on speed

// The first true answer; one that throws is none.
export async function until(what, ready, limit = watchdog) {
  const end = Date.now() + limit;
  for (;;) {
    let why = '';
    try {
      const answer = await ready();
      if (answer) return answer;
    } catch (error) {
      why = error.message;
    }
    if (Date.now() > end) throw new Error(`${what}: not within ${limit / 1000} s; ${why}`);
    await new Promise((resolve) => setTimeout(resolve, 30));
  }
}

export function check(is_so, what) {
  if (!is_so) throw new Error(what);
}

export function same(got, wanted, what) {
  const [a, b] = [JSON.stringify(got), JSON.stringify(wanted)];
  if (a !== b) throw new Error(`${what}: got ${a}, wanted ${b}`);
}

// Waits until what is read is what is wanted, and tells what was read last.
export async function becomes(read, wanted, what) {
  const text = JSON.stringify(wanted);
  let got = 'nothing';
  try {
    await until(what, async () => (got = JSON.stringify(await read()) ?? 'undefined') === text);
  } catch (error) {
    throw new Error(`${error.message} got ${got}, wanted ${text}`);
  }
}

export async function free_port() {
  const server = createServer();
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return port;
}

// As tests/scenario/server_ids.py: a socket that stays bound says that an id is taken.
const claims = [];
async function claim_server_id() {
  const begin = 1000 + ((process.pid * 3) % 3900);
  for (let i = 0; i < 3990; ++i) {
    const id = 1000 + ((begin - 1000 + i) % 3990);
    const socket = createSocket('udp4');
    const is_mine = await new Promise((resolve) => {
      socket.once('error', () => resolve(false));
      socket.bind({ port: 10000 + id, address: '127.0.0.1', exclusive: true }, () => resolve(true));
    });
    if (is_mine) {
      socket.unref();
      claims.push(socket);
      return id;
    }
    socket.close();
  }
  throw new Error('no server id is free');
}

const rigs = new Set(); // those that have not ended
let is_ending = false;
const stop_here = () => new Promise(() => {}); // end_early ends the process

export class Rig {
  constructor(bin, source, lib = join(bin, '../lib')) {
    rigs.add(this);
    Object.assign(this, { bin, source, lib, running: [], work: mkdtempSync(join(tmpdir(), 'studio-')) });
  }

  async claim() {
    this.server_id = await claim_server_id();
    this.names_port = await free_port();
    this.names = `127.0.0.1:${this.names_port}`;
  }

  start(name, words) {
    if (is_ending) throw new Error('this run was told to end');
    const log = join(this.work, `${this.running.length}.log`);
    const file = openSync(log, 'w');
    const program = name === 'rtm-studio' && process.env.STUDIO_SERVER ? process.env.STUDIO_SERVER : existsSync(join(this.bin, name)) ? join(this.bin, name) : name;
    const child = spawn(program, words, { stdio: ['ignore', file, file], cwd: this.folder ?? this.work, env: { ...process.env, RTMSIM_SERVER_ID: String(this.server_id) } });
    child.log = () => readFileSync(log, 'utf8');
    child.words = [name, ...words];
    child.ended = new Promise((resolve) => child.once('exit', resolve));
    this.running.push(child);
    return child;
  }

  async end(child, signal = 'SIGTERM') {
    if (child.exitCode !== null || child.signalCode !== null) return;
    child.kill(signal);
    const timer = setTimeout(() => child.kill('SIGKILL'), 20000);
    await child.ended;
    clearTimeout(timer);
  }

  async end_all() {
    rigs.delete(this);
    for (const child of [...this.running].reverse()) await this.end(child);
    rmSync(this.work, { recursive: true, force: true });
    const left = readdirSync('/dev/shm').filter((name) => name.startsWith(`rtmsim-${process.getuid()}-${this.server_id}.`));
    check(left.length === 0, `left in /dev/shm: ${left}`);
  }

  logs() {
    return this.running.map((child) => `--- ${child.words.join(' ')} (${child.exitCode ?? child.signalCode ?? 'runs'})\n${child.log().slice(-2000)}`).join('\n');
  }

  async call(name, ...words) {
    const env = { ...process.env, RTMSIM_SERVER_ID: String(this.server_id) };
    return (await promisify(execFile)(join(this.bin, name), words, { timeout: watchdog, env, cwd: this.work })).stdout;
  }
  simctl(...words) { return this.call('simctl', '-s', String(this.server_id), ...words); }
  rtse(...words) { return this.call('rtse', '--ns', this.names, ...words); }

  async naming() {
    const data = mkdtempSync(join(this.work, 'names-'));
    const child = this.start('omniNames', ['-start', String(this.names_port), '-datadir', data, '-ORBendPoint', `giop:tcp:${this.names}`]);
    await until('naming service', async () => (await this.rtse('ls')) !== undefined);
    return child;
  }

  async server(world, ...options) {
    const child = this.start('sim-server', [resolve(this.source, world), '-s', String(this.server_id), ...options]);
    await until('simulator', async () => child.exitCode === null && (await this.simctl('stats')));
    return child;
  }

  host(...components) {
    return this.start('rtcd', ['-o', `corba.nameservers:${this.names}`, '-o', `manager.modules.load_path:${this.lib}`, '-o', 'manager.shutdown_auto:NO', '-o', 'naming.update.interval:1', ...components]);
  }
  device(component) { return `${component}?conf.default.server_id=${this.server_id}`; }

  async studio(...options) {
    const child = this.start('rtm-studio', ['--ns', this.names, '-s', String(this.server_id), ...(options.includes('-p') ? [] : ['-p', '0']), ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : []), ...options]);
    child.url = await until('rtm-studio', () => /http:\/\/\S+/.exec(child.log())?.[0]);
    return child;
  }

  async speed(iface = 'pioneer2dx::position2d') {
    return JSON.parse(await this.simctl('--json', 'echo', iface, '-n', '1')).velocity[0];
  }
}

export async function launch() {
  const { chromium } = await import('playwright-core');
  // Without the frame of a desktop browser, which headless mode draws too: half of the processor time.
  const executablePath = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
  if (!executablePath) return null;
  // Signals are for run().
  return chromium.launch({ executablePath, timeout: watchdog, handleSIGINT: false, handleSIGTERM: false, handleSIGHUP: false, args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'] });
}

// A page of its own, without anything remembered. Errors of the page fail the flow that runs.
export async function open(browser, url, { width = 1280, height = 800, scheme = 'light', ...more } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: 'reduce', ...more });
  context.setDefaultTimeout(watchdog); // of its other pages, too
  const page = await context.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(error.message));
  page.on('console', (message) => { if (message.type() === 'error' && !/WebSocket connection|Failed to load resource|net::ERR/.test(message.text())) page.problems.push(message.text()); });
  if (url) await page.goto(url);
  return page;
}

export const is_ready = (page) => page.waitForFunction(() => window.studio && window.studio.wire.status === 'open' && window.studio.store.hello);
export const has_world = (page) => page.waitForFunction(() => window.studio && window.studio.world.frames > 0);

// What the page has been told is drawn: two pictures have begun.
export const drawn = (page) => page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));

// Of two images, URLs: the mean difference of a component, 0..255, and the share of pixels that differ by more than 32.
export async function compared(page, one_url, other_url) {
  return page.evaluate(async ([a, b]) => {
    const pixels = async (url) => {
      const bitmap = await createImageBitmap(await (await fetch(url)).blob());
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      const draw = canvas.getContext('2d');
      draw.drawImage(bitmap, 0, 0);
      return draw.getImageData(0, 0, bitmap.width, bitmap.height);
    };
    const [one, two] = [await pixels(a), await pixels(b)];
    if (one.width !== two.width || one.height !== two.height) throw new Error(`sizes ${one.width}x${one.height} and ${two.width}x${two.height}`);
    let sum = 0, far = 0;
    for (let i = 0; i < one.data.length; i += 4) {
      const d = [0, 1, 2].map((c) => Math.abs(one.data[i + c] - two.data[i + c]));
      sum += d[0] + d[1] + d[2];
      far += Math.max(...d) > 32 ? 1 : 0;
    }
    return { mean: sum / (one.width * one.height * 3), far: far / (one.width * one.height) };
  }, [one_url, other_url]);
}

// Told to end: what was started has ended, too, when this has.
async function end_early(browser, status) {
  if (is_ending) return;
  is_ending = true;
  await Promise.allSettled([browser.close(), ...[...rigs].map((rig) => rig.end_all())]);
  process.exit(status);
}

// Runs flows one after the other in one browser: [name, work]. Exit status 77 without a browser.
export async function run(flows, set_up, take_down, how = { launch, missing: 'no chromium-headless-shell (scripts/setup installs it)' }) {
  const browser = await how.launch();
  if (!browser) {
    console.log(`skipped: ${how.missing}`);
    process.exit(77);
  }
  for (const [signal, number] of [['SIGHUP', 1], ['SIGINT', 2], ['SIGTERM', 15]]) process.on(signal, () => end_early(browser, 128 + number));
  const only = process.env.STUDIO_FLOW;
  let failed = 0;
  let shared;
  try {
    shared = await set_up(browser);
    for (const [name, work] of flows) {
      if (only && !only.split('|').some((o) => name.includes(o))) continue;
      const began = Date.now();
      try {
        await work(shared);
        const problems = shared.page?.problems.splice(0) ?? [];
        check(problems.length === 0, `the page says: ${problems.join('; ')}`);
        console.log(`ok    ${name} (${Date.now() - began} ms)`);
      } catch (error) {
        if (is_ending) await stop_here();
        failed += 1;
        console.log(`FAIL  ${name}: ${error.stack}`);
        if (process.env.STUDIO_PICTURES) await shared.page?.screenshot({ path: join(process.env.STUDIO_PICTURES, `${name.replaceAll(' ', '_')}.png`) }).catch(() => {});
        console.log('      open requests:', await shared.page?.evaluate(() => JSON.stringify([...window.studio.wire.open.values()].map((w) => w.text))).catch(() => '?'));
        if (shared.rig && process.env.STUDIO_LOGS) console.log(shared.rig.logs());
      }
    }
  } catch (error) {
    if (is_ending) await stop_here();
    failed += 1;
    console.log(`FAIL  set-up: ${error.stack}`);
    if (shared?.rig) console.log(shared.rig.logs());
  } finally {
    if (is_ending) await stop_here();
    await browser.close();
    try {
      await take_down?.(shared);
      for (const rig of [...rigs]) await rig.end_all(); // of a set-up that has failed
    } catch (error) {
      failed += 1;
      console.log(`FAIL  the end: ${error.message}`);
    }
  }
  console.log(failed === 0 ? 'all is well' : `${failed} failed`);
  process.exit(failed === 0 ? 0 : 1);
}
