// The page that `rtse run --page` leaves, from a disk and without a network. run_page_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
import { existsSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { flows as recorded_flows, moment, robot, near, scrub } from './recorded_steps.mjs';
import { check, has_world, is_ready, open, Rig, run, same, until } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);
const worlds = join(source, 'worlds');
const avoid = join(worlds, 'systems/obstacle_avoidance.xml');
const course = join(worlds, 'obstacle_course.sdf');

// Every request but that of the file itself is a fault.
async function open_file(browser, file, hash = '', options = {}) {
  const page = await open(browser, undefined, { offline: true, ...options });
  page.requests = [];
  page.on('request', (request) => { if (!/^(data|blob):/.test(request.url())) page.requests.push(request.url()); });
  await page.goto(pathToFileURL(file).href + hash);
  return page;
}

async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  await rig.claim();
  const file = join(rig.work, 'run.mcap');
  const html = join(rig.work, 'run.html');
  await rig.call('rtse', 'run', avoid, '-w', course, '-d', '12', '--seed', '7', '--record', file, '--page', html, '--module-path', lib);
  const page = await open_file(browser, html);
  await is_ready(page);
  await has_world(page);
  return { browser, rig, file, html, page };
}

const summary = (page) => page.locator('.run-summary').textContent();

const flows = [
  ['the summary has verdict, seed, hash and the command that repeats the run', async ({ page }) => {
    const text = await summary(page);
    for (const part of ['passed', 'seed7', 'rtse run', '--seed 7', '--duration 12']) check(text.includes(part), `${part} in ${text}`);
    check(/state[0-9a-f]{16}/.test(text), text);
  }],
  ['what needs a running system is not shown', async ({ page }) => {
    for (const id of ['save', 'open', 'open-recording', 'copy-link', 'activate-all', 'deactivate-all', 'forget-dead']) check(await page.locator(`#${id}`).isHidden(), id);
    same(await page.locator('.diagram .box .name').allTextContents(), ['RTCLaser0', 'LaserObstacleAvoid0', 'RTCPosition2d0'], 'components');
  }],
  ['nothing but the file is loaded, and the file is small', async ({ page, html }) => {
    same(page.requests, [page.url().replace(/#.*/, '')], 'requests');
    check(statSync(html).size < 2e6, `${statSync(html).size} bytes`);
    check(!/https?:\/\/(?!www\.w3\.org)/.test(readFileSync(html, 'utf8').replace(/<script[^]*?<\/script>/g, '')), 'no address of a network');
  }],
  ['without --record nothing but the page is left', async ({ rig, browser }) => {
    const html = join(rig.work, 'alone.html');
    await rig.call('rtse', 'run', avoid, '-w', course, '-d', '1', '--page', html, '--module-path', lib);
    same(readdirSync(rig.work).filter((name) => name.startsWith('alone')), ['alone.html'], 'files');
    const page = await open_file(browser, html);
    await has_world(page);
    await page.context().close();
  }],
  ['a failed run opens at its end with the reason on top', async ({ rig, browser }) => {
    const html = join(rig.work, 'failed.html');
    const expectations = join(rig.work, 'expect.yaml');
    writeFileSync(expectations, '- path_length: {model: pioneer2dx, min: 100}\n');
    const failed = await rig.call('rtse', 'run', avoid, '-w', course, '-d', '3', '--expect', expectations, '--page', html, '--module-path', lib).then(() => false, () => true);
    check(failed && existsSync(html), 'the run fails and leaves its page');
    const page = await open_file(browser, html);
    await has_world(page);
    check((await summary(page)).includes('failed') && (await summary(page)).includes('path_length'), await summary(page));
    await until('its end', async () => Math.abs((await moment(page)) - 3) < 0.05);
    await page.context().close();
  }],
  ['an exported recording has a page without a verdict', async ({ rig, browser, file }) => {
    const html = join(rig.work, 'exported.html');
    await rig.call('rtse', 'recording', 'export', file, '--html', html);
    const page = await open_file(browser, html);
    await has_world(page);
    check((await summary(page)).includes('recorded'), await summary(page));
    const before = await robot(page);
    await scrub(page, 9);
    await until('another place', async () => !near(await robot(page), before));
    await page.context().close();
  }],
  ['damaged data leave a message', async ({ rig, browser, html }) => {
    const broken = join(rig.work, 'broken.html');
    const text = readFileSync(html, 'utf8');
    const damage = (id) => text.replace(new RegExp(`(id="run-${id}">.{40})[^<]{60}`), '$1' + 'A'.repeat(60));
    for (const id of ['index', '0', 'world', 'parameters']) {
      writeFileSync(broken, damage(id));
      const page = await open_file(browser, broken);
      await until(`a message about ${id}`, async () => /damaged|data of this page|cannot|compressed|JSON/i.test(await page.locator('body').innerText()));
      await page.context().close();
    }
  }],
  ['narrow and dark', async ({ browser, html }) => {
    const page = await open_file(browser, html, '', { width: 360, height: 700, scheme: 'dark' });
    await has_world(page);
    check(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'no sideways scrolling');
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'run_page_narrow.png') });
    same(page.problems, [], 'problems');
    await page.context().close();
  }],
];

run([...flows, ...recorded_flows], set_up, async (shared) => shared?.rig.end_all());
