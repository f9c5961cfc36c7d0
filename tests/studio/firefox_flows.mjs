// The page that `rtse run --page` leaves, in Firefox: firefox_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR. Skipped without firefox-esr, which nothing
// else needs. Firefox draws with WebGL only on a display (Xvfb); without one it shows everything but the world.
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { becomes, check, has_world, is_ready, open, Rig, run, same, until, watchdog } from './rig.mjs';
import { moment, scrub } from './recorded_steps.mjs';
import { write_pages } from './run_pages.mjs';

const [bin, source, lib] = process.argv.slice(2);
const executablePath = '/usr/bin/firefox-esr';
// Every address of a network is refused.
const nowhere = { 'network.proxy.type': 1, 'network.proxy.socks': '127.0.0.1', 'network.proxy.socks_port': 9, 'network.proxy.no_proxies_on': '' };

async function firefox(display) {
  const { default: playwright } = await import('playwright-core');
  return playwright._bidiFirefox.launch({
    executablePath, timeout: watchdog, headless: !display, handleSIGINT: false, handleSIGTERM: false, handleSIGHUP: false,
    firefoxUserPrefs: { ...nowhere, 'webgl.force-enabled': Boolean(display) }, env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1', ...(display && { DISPLAY: display }) },
  });
}

let server; // of the display
async function display() {
  server = spawn('Xvfb', ['-displayfd', '3', '-screen', '0', '1400x1000x24', '-nolisten', 'tcp', '-noreset'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe'] });
  let number = '';
  server.stdio[3].on('data', (text) => { number += text; });
  await until('Xvfb', () => number.includes('\n'));
  return `:${number.trim()}`;
}

const launch = async () => (existsSync(executablePath) ? firefox(await display()) : null);

async function open_file(browser, html, options = {}) {
  const page = await open(browser, undefined, options);
  page.requests = [];
  page.on('request', (request) => { if (!/^(data|blob):/.test(request.url())) page.requests.push(request.url()); });
  await page.goto(pathToFileURL(html).href);
  await is_ready(page);
  return page;
}

const picture = async (page, name) => {
  if (!process.env.STUDIO_PICTURES) return;
  const before = page.problems.length;
  await page.screenshot({ path: join(process.env.STUDIO_PICTURES, `firefox_${name}.png`) });
  page.problems.splice(before); // Playwright adds a style to the page, which the page refuses
};

// Of the picture of the world.
const colours = (page) => page.evaluate(() => {
  const { world } = window.studio, copy = document.createElement('canvas');
  [copy.width, copy.height] = [64, 48];
  world.draw(true);
  const pen = copy.getContext('2d');
  pen.drawImage(world.canvas, 0, 0, copy.width, copy.height);
  return new Set(new Uint32Array(pen.getImageData(0, 0, copy.width, copy.height).data.buffer)).size;
});
const places = (page) => page.evaluate(() => Array.from(window.studio.world.places()));

// The world, the time line, a plot, the log, and nothing from elsewhere.
async function use(browser, { name, html, robots }) {
  const page = await open_file(browser, html);
  await has_world(page);
  check((await page.evaluate(() => window.studio.store.world.models.filter((m) => !m.static).length)) >= robots, `${name}: robots`);
  await until(`${name} is drawn`, async () => (await colours(page)) > 20);
  await scrub(page, 0.1);
  const before = JSON.stringify(await places(page));
  await scrub(page, 1.5);
  await until(`${name} moves`, async () => JSON.stringify(await places(page)) !== before);
  await picture(page, name);
  const topic = await page.evaluate(() => window.studio.store.signals.find((s) => s.kind === 'port' && s.topic.endsWith('/odometry'))?.topic ?? '');
  if (topic) {
    await page.evaluate((one) => window.studio.bottom.plots.add(one, 'data.position.x'), topic);
    await until(`${name}: a plot`, () => page.evaluate(() => window.studio.bottom.plots.plots[0].lines[0].times.length > 5));
    await page.locator('.plot canvas').waitFor();
  }
  if (name === 'farm') {
    await page.evaluate(() => window.studio.bottom.show_image(`camera:${window.studio.store.world.ifaces.find((i) => i.type === 'camera').name}`));
    await until('an image', () => page.evaluate(() => document.querySelector('.images img')?.naturalWidth > 0));
    await picture(page, 'farm_camera');
  }
  const lines = await page.evaluate(() => window.studio.store.hello.recording.lines.length);
  await scrub(page, 2);
  await page.locator('#tab-logs').click();
  await until(`${name}: the log`, async () => (lines > 0) === ((await page.locator('.log > div').count()) > 0));
  same(page.requests.filter((one) => one !== page.url().replace(/#.*/, '')), [], `${name}: requests`);
  same(page.problems, [], `${name}: problems`);
  await page.context().close();
}

async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  await rig.claim();
  const pages = [];
  await write_pages(rig, lib, source, (one) => pages.push(one));
  return { browser, rig, pages };
}

const flows = [
  ...['course', 'farm', 'lead', 'failed', 'hundred'].map((kind) => [`the page of a run is used: ${kind}`, ({ browser, pages }) => use(browser, pages.find(({ name }) => name === kind))]),
  ['a failed run opens at its end with the reason on top', async ({ browser, pages }) => {
    const page = await open_file(browser, pages.find(({ name }) => name === 'failed').html, { width: 360, height: 700 });
    await has_world(page);
    await until('the reason', async () => /failed[^]*path_length/.test(await page.locator('.run-summary').textContent()));
    await until('the end', async () => Math.abs((await moment(page)) - 2) < 0.05);
    await until('as wide as the screen', () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await picture(page, 'narrow');
    await page.context().close();
  }],
  ['without WebGL there is everything but the world', async ({ pages }) => {
    const browser = await firefox();
    try {
      const page = await open_file(browser, pages[0].html);
      await until('it says so', async () => (await page.locator('.world .notice').textContent()).includes('no WebGL 2'));
      await scrub(page, 1.5);
      await becomes(() => page.locator('.diagram .box').count(), 3, 'components');
      await picture(page, 'without_webgl');
    } finally {
      await browser.close();
    }
  }],
];

run(flows, set_up, async (shared) => {
  await shared?.rig.end_all();
  server?.kill();
}, { launch, missing: 'no firefox-esr (apt-get install firefox-esr)' });
