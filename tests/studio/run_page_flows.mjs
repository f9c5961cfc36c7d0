// The page that `rtse run --page` leaves, from a disk and without a network. run_page_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
import { readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { deflateSync, inflateSync } from 'node:zlib';
import { flows as recorded_flows, moment, near, recorded_place, robot, scrub } from './recorded_steps.mjs';
import { mutate_in_page } from './mutate_in_page.mjs';
import { blocks_of, json_of, mutated, random } from './page_mutations.mjs';
import { looks_like_the_studio, small } from './page_pixels.mjs';
import { write_pages } from './run_pages.mjs';
import { becomes, check, has_world, is_ready, open, Rig, run, same, until, watchdog } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);
const worlds = join(source, 'worlds');
const avoid = join(worlds, 'systems/obstacle_avoidance.xml');
const course = join(worlds, 'obstacle_course.sdf');
const axe = createRequire(import.meta.url).resolve('axe-core/axe.min.js');

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

const fails = (promise) => promise.then(() => false, () => true);
const selection = (page) => page.evaluate(() => { const { selection, system } = window.studio.store; return system.components.find((c) => c.path === selection?.id)?.instance ?? selection?.id; });

// A run that fails leaves a page, which is opened.
async function failed_page({ rig, browser }, name, expectations, ...options) {
  const html = join(rig.work, `${name}.html`), file = join(rig.work, `${name}.yaml`);
  writeFileSync(file, expectations);
  check(await fails(rig.call('rtse', 'run', avoid, '-w', course, '-d', '4', '--expect', file, '--page', html, '--module-path', lib, ...options)), 'the run fails');
  const page = await open_file(browser, html);
  await has_world(page);
  return page;
}

const summary = (page) => page.locator('.run-summary').textContent();

const flows = [
  ['the summary has verdict, seed, hash and the command that repeats the run', async ({ page }) => {
    const text = await summary(page);
    for (const part of ['passed', 'seed7', 'rtse run', '--seed 7', '--duration 12']) check(text.includes(part), `${part} in ${text}`);
    check(/state[0-9a-f]{16}/.test(text), text);
  }],
  ['what needs a running system is not shown', async ({ page }) => {
    for (const id of ['save', 'open', 'open-recording', 'copy-link', 'activate-all', 'deactivate-all', 'forget-dead']) await page.locator(`#${id}`).waitFor({ state: 'hidden' });
    await becomes(() => page.locator('.diagram .box .name').allTextContents(), ['RTCLaser0', 'LaserObstacleAvoid0', 'RTCPosition2d0'], 'components');
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
  ['a failure of the whole run opens at its end with the reason on top', async (shared) => {
    const page = await failed_page(shared, 'failed', '- path_length: {model: pioneer2dx, min: 100}\n');
    check((await summary(page)).includes('failed') && (await summary(page)).includes('path_length'), await summary(page));
    await until('its end', async () => Math.abs((await moment(page)) - 4) < 0.05);
    await until('the model', async () => (await selection(page)) === 'pioneer2dx');
    await page.context().close();
  }],
  ['a failed run opens at the time of the first violation with its object', async (shared) => {
    const page = await failed_page(shared, 'violated', '- value: {port: "LaserObstacleAvoid0:velocity", member: data.vx, max: 0.1}\n- stay: {model: pioneer2dx, region: [-4.55, -4.55, -4.45, -4.45]}\n');
    const marks = await page.evaluate(() => window.studio.store.hello.page.marks.map(({ time, kind, subject }) => [time, kind, subject]));
    same(marks.map(([, kind]) => kind), ['failure', 'failure'], 'marks');
    check(marks.every(([time]) => time < 4), `times ${JSON.stringify(marks)}`);
    same(marks.map(([, , subject]) => subject).sort(), ['LaserObstacleAvoid0', 'pioneer2dx'], 'objects');
    await until('the first', async () => Math.abs((await moment(page)) - marks[0][0]) < 1e-6);
    await until('its object', async () => (await selection(page)) === marks[0][2]);
    await page.locator('.run-summary .why button').last().click();
    await until('the second', async () => Math.abs((await moment(page)) - marks[1][0]) < 1e-6 && (await selection(page)) === marks[1][2]);
    await page.locator('.mark-lane i').first().click();
    await until('the first again', async () => Math.abs((await moment(page)) - marks[0][0]) < 1e-6);
    same(page.problems, [], 'problems');
    await page.context().close();
  }],
  ['a component in error opens the page at its transition', async (shared) => {
    const page = await failed_page(shared, 'error', '- state: {component: LaserObstacleAvoid0, is: Active}\n', '--property', 'LaserObstacleAvoid0:fault.on_execute=error:2:0:0:1');
    await until('the transition', async () => Math.abs((await moment(page)) - 2) < 0.15);
    await until('the component', async () => (await selection(page)) === 'LaserObstacleAvoid0');
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
  ['hostile names and texts stay text', async ({ rig, browser, html }) => {
    const hostile = join(rig.work, 'hostile.html'), text = readFileSync(html, 'utf8'), packed = blocks_of(text).get('index');
    const bad = '<img src=x onerror="window.bad=1"></script><b id="bad">x</b>';
    const index = JSON.parse(inflateSync(Buffer.from(packed, 'base64')).toString());
    Object.assign(index.hello.page, { passed: false, why: [bad], command: bad, left_out: [bad], marks: [{ time: 1, kind: bad, text: bad, subject: bad }] });
    index.hello.recording.lines = [[0.5, 'ERROR', bad, bad]];
    index.system.components[0].instance = index.world.models[0].name = bad;
    writeFileSync(hostile, text.replace(packed, deflateSync(JSON.stringify(index)).toString('base64')));
    const page = await open_file(browser, hostile);
    await has_world(page);
    await page.locator('#tab-logs').click();
    check((await summary(page)).includes(bad), 'the text is shown');
    same(await page.evaluate(() => [window.bad, document.getElementById('bad')]), [null, null], 'nothing of it is an element');
    await page.context().close();
  }],
  ['mutated data leave a message or a run, never a blank page', async ({ rig, browser, html }) => {
    const broken = join(rig.work, 'mutated.html');
    const text = readFileSync(html, 'utf8'), blocks = blocks_of(text), ids = [...blocks.keys()], pick = random(Number(process.env.STUDIO_SEED ?? 1));
    const json = json_of(blocks);
    const page = await open_file(browser, html);
    for (let i = 0; i < 8; ++i) {
      const id = pick.of(ids), at = text.indexOf(`id="run-${id}">`) + `id="run-${id}">`.length;
      writeFileSync(broken, text.slice(0, at) + mutated(blocks.get(id), json.get(id), pick) + text.slice(at + blocks.get(id).length));
      await page.goto(pathToFileURL(broken).href);
      await until(`page ${i}, block ${id}`, () => page.evaluate(() => window.studio?.world.frames > 0 || /damaged|cannot be|data of this page|page has no/.test(document.body.innerText)));
    }
    await page.context().close();
  }],
  ['a page whose data change is read again, whatever they are', async ({ browser, html }) => {
    const said = await mutate_in_page(await open_file(browser, html, '', { width: 500, height: 400 }), html, Number(process.env.STUDIO_MUTATIONS ?? 40), Number(process.env.STUDIO_SEED ?? 1));
    console.log(`      ${said}`);
  }],
  ['axe finds nothing serious, light and dark', async ({ browser, html }) => {
    for (const scheme of ['light', 'dark']) {
      const page = await open_file(browser, html, '', { scheme, bypassCSP: true });
      await has_world(page);
      await page.addScriptTag({ path: axe });
      const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
      same(violations.filter(({ impact }) => impact === 'serious' || impact === 'critical').map(({ id, nodes }) => [id, nodes[0].html]), [], scheme);
      await page.context().close();
    }
  }],
  ['two runs are compared: ghosts, dashed lines and the first difference', async ({ rig, browser, file }) => {
    const other = join(rig.work, 'other.mcap'), html = join(rig.work, 'compared.html');
    await rig.call('rtse', 'run', avoid, '-w', course, '-d', '14', '--seed', '8', '--record', other, '--module-path', lib);
    await rig.call('rtse', 'page', file, other, '-o', html);
    const said = await rig.call('rtse', 'recording', 'compare', file, other).catch((error) => error.stdout);
    const page = await open_file(browser, html);
    await has_world(page);
    const text = await summary(page);
    check(text.includes('compared') && text.includes('other.mcap') && text.includes('first difference'), text);
    const [, time] = /at time ([0-9.]+) s/.exec(said);
    await until('the first difference', async () => Math.abs((await moment(page)) - Number(time)) < 1e-6);
    await becomes(() => page.locator('.mark-lane .difference').count(), 1, 'marks');
    const ghost = () => page.evaluate(() => window.studio.world.ghosts.world?.models.get('pioneer2dx').canonical.position.toArray());
    for (const at of [11, 4]) {
      await scrub(page, at);
      const wanted = await recorded_place(rig, other, at);
      await until(`the ghost at ${at} s`, async () => near(await ghost(), wanted));
    }
    await scrub(page, 13.5);
    const late = await recorded_place(rig, other, 13.5);
    await until('the ghost behind the end of the first', async () => near(await ghost(), late));
    await page.evaluate(() => window.studio.bottom.plots.add('/LaserObstacleAvoid0/velocity', 'data.vx'));
    await until('the line of the other', () => page.evaluate(() => window.studio.bottom.plots.plots.at(-1).lines[0].other?.[0].at(-1) > 13.5));
    same(page.problems, [], 'problems');
    await page.context().close();
  }],
  ['equal recordings are compared without a difference', async ({ rig, browser, file }) => {
    const html = join(rig.work, 'equal.html');
    await rig.call('rtse', 'page', file, file, '-o', html);
    const page = await open_file(browser, html);
    await has_world(page);
    check((await summary(page)).includes('equal: '), await summary(page));
    same(await page.locator('.mark-lane i').count(), 0, 'marks');
    await page.context().close();
  }],
  ['pages of an obstacle course, a farm with a camera, a leader, a failed run and a hundred robots look like the studio', async ({ rig, browser }) => {
    await write_pages(rig, lib, source, async ({ name, html, file, robots }) => {
      const page = await open_file(browser, html, '', small);
      await has_world(page);
      const moving = await page.evaluate(() => window.studio.store.world.models.filter((m) => !m.static).length);
      check(moving >= robots, `${name}: ${moving} models`);
      console.log(`      ${name}: ${(statSync(html).size / 1e6).toFixed(2)} MB`);
      await looks_like_the_studio({ rig, browser }, page, file);
      if (name === 'farm') {
        await page.evaluate(() => window.studio.bottom.show_image(`camera:${window.studio.store.world.ifaces.find((i) => i.type === 'camera').name}`));
        await until('an image', () => page.evaluate(() => document.querySelector('.images img')?.naturalWidth > 0));
      }
      same(page.requests, [page.url().replace(/#.*/, '')], 'requests');
      same(page.problems, [], name);
      await page.context().close();
    });
  }],
  ['scrubbing ends at the time of the hand, and shows times on the way', async ({ browser, html }) => {
    const page = await open_file(browser, html);
    await has_world(page);
    await until('a first time and picture', () => page.evaluate(() => window.studio.store.time && performance.getEntriesByName('first-picture').length > 0));
    const { shown, drawn, seconds, first } = await page.evaluate(async (limit) => {
      const { playback, store, world } = window.studio, times = new Set(), began = performance.now(), frames = world.frames;
      const passed = () => performance.now() - began;
      for (let i = 1; i <= 150 || (times.size <= 10 && passed() < limit); ++i) {
        playback.seek((11.9 * ((i * 37) % 150)) / 150);
        await new Promise((resolve) => setTimeout(resolve));
        times.add(store.time.sim_time);
      }
      playback.seek(0);
      return { shown: times.size, drawn: world.frames - frames, seconds: passed() / 1000, first: performance.getEntriesByName('first-picture')[0].startTime };
    }, watchdog);
    console.log(`      first picture after ${first.toFixed(0)} ms, ${(shown / seconds).toFixed(0)} times and ${(drawn / seconds).toFixed(0)} pictures a second`);
    await until('the last', async () => Math.abs((await moment(page)) - 0) < 1e-6);
    check(shown > 10, `${shown} times`);
    await page.context().close();
  }],
  ['a run that is killed leaves the page before it', async ({ rig }) => {
    const html = join(rig.work, 'kept.html');
    writeFileSync(html, 'the page before');
    const run = rig.start('rtse', ['run', avoid, '-w', course, '-d', '3000', '--page', html, '--module-path', lib]);
    await until('its recording', () => readdirSync(rig.work).some((name) => name.startsWith('kept.html.') && name.endsWith('.mcap')));
    run.kill('SIGKILL');
    await run.ended;
    same(readFileSync(html, 'utf8'), 'the page before', 'page');
  }],
  ['narrow and dark', async ({ browser, html }) => {
    const page = await open_file(browser, html, '', { width: 360, height: 700, scheme: 'dark' });
    await has_world(page);
    await until('no sideways scrolling', () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'run_page_narrow.png') });
    same(page.problems, [], 'problems');
    await page.context().close();
  }],
];

run([...flows, ...recorded_flows], set_up, async (shared) => shared?.rig.end_all());
