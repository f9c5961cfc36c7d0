// A recording in the page: made by rtse run, opened by rtm-studio without anything that runs. recording_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
import { execFile } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, relative } from 'node:path';
import { promisify } from 'node:util';
import { choose, flows as recorded_flows, moment, near, path_of, robot, scrub } from './recorded_steps.mjs';
import { becomes, check, has_world, is_ready, open, Rig, run, same, until, watchdog } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);
const worlds = join(source, 'worlds');

async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  await rig.claim();
  const file = join(rig.work, 'run.mcap');
  await rig.call('rtse', 'run', join(worlds, 'systems/obstacle_avoidance.xml'), '-w', join(worlds, 'obstacle_course.sdf'), '-d', '12', '--record', file, '--module-path', lib);
  const studio = rig.start('rtm-studio', [file, '-p', '0', ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : [])]);
  const url = await until('rtm-studio', () => /http:\/\/\S+/.exec(studio.log())?.[0]);
  const page = await open(browser, url);
  await is_ready(page);
  await has_world(page);
  return { browser, rig, file, studio, url, page };
}

const flows = [
  ['the page says what it shows, and for how long', async ({ page }) => {
    await until('head', async () => (await page.locator('.top .what').textContent()).includes('run.mcap, 12.0 s recorded'));
    await until('foot', async () => (await page.locator('footer').textContent()).includes('recording: read-only'));
    await page.locator('#live').waitFor({ state: 'hidden' });
    await becomes(() => page.locator('.diagram .box .name').allTextContents(), ['RTCLaser0', 'LaserObstacleAvoid0', 'RTCPosition2d0'], 'components');
    await becomes(() => page.locator('.diagram .edge').count(), 2, 'connections');
    await until('nothing can be done to it', () => page.locator('#activate-all').isDisabled());
  }],
  ['the time line is as long as the recording before the first frame is drawn', async ({ browser, url }) => {
    const page = await open(browser);
    await page.addInitScript(() => { window.requestAnimationFrame = () => 0; });
    await page.goto(url);
    await until('hello', () => page.evaluate(() => window.studio?.store.hello !== undefined));
    const range = await page.locator('.scrub').evaluate((slider) => [Number(slider.min), Number(slider.max)]); // at once: without a frame
    check(range[0] < 0.2 && range[1] > 11.8, `from ${range[0]} to ${range[1]}`);
    await page.context().close();
  }],
  ['a component is replayed, and its outputs are equal; the command that does it is shown', async ({ page, rig, file }) => {
    await choose(page, 'component', await path_of(page, 'LaserObstacleAvoid0'));
    await page.locator('#replay').click();
    await page.locator('#replayed', { hasText: 'equal' }).waitFor();
    await page.keyboard.press('Escape');
    const command = `rtse replay ${file} --into LaserObstacleAvoid0 --compare`;
    await becomes(() => page.locator('.status .command').textContent(), command, 'the command');
    await rig.call(...command.split(' '), '--module-path', rig.lib);
  }],
  ['the next time at which a value becomes true of a comparison is gone to', async ({ page }) => {
    await scrub(page, 0);
    await choose(page, 'signal', '/LaserObstacleAvoid0/velocity');
    await page.locator('#pause-when').click();
    await page.locator('#break-member').selectOption('data.vx');
    await page.locator('#break-compare').selectOption('>');
    await page.locator('#break-value').fill('0.199');
    await page.locator('dialog[open] button.main').click();
    await until('a later time', async () => (await moment(page)) > 0 && (await page.locator('.status .act').textContent()).includes('data.vx > 0.199 at'));
  }],
  ['two viewers have two moments', async ({ browser, page, url }) => {
    const other = await open(browser, url);
    await has_world(other);
    await scrub(page, 10);
    await scrub(other, 2);
    check(Math.abs((await moment(page)) - 10) < 1e-6, 'the first one stays');
    await until('two places', async () => !near(await robot(page), await robot(other)));
    await other.context().close();
  }],
  ['a link holds the moment', async ({ browser, page }) => {
    await scrub(page, 4.5);
    const link = await until('the link', async () => { const href = await page.evaluate(() => location.href); const text = Buffer.from(href.split('#v=')[1] ?? '', 'base64url').toString(); return text.includes('"moment":4.5') && href; });
    const context = page.context();
    const other = await context.newPage();
    await other.goto(link);
    await is_ready(other);
    await until('the same moment', async () => Math.abs((await moment(other)) - 4.5) < 1e-6);
    await other.close();
    void browser;
  }],
  ['the page comes back with a studio of the same recording', async ({ page, rig, file, studio, url }) => {
    await scrub(page, 5);
    await rig.end(studio);
    await until('it waits', () => page.evaluate(() => window.studio.wire.status !== 'open'));
    const port = new URL(url).port;
    const again = rig.start('rtm-studio', [file, '-p', port, ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : [])]);
    const fresh = await until('rtm-studio', () => /http:\/\/\S+/.exec(again.log())?.[0]);
    await page.goto(fresh);
    await is_ready(page);
    await has_world(page);
    await rig.end(again);
  }],
  ['a recording is opened from the page, seen by all, and closed', async ({ rig, browser }) => {
    const studio = await rig.studio();
    const page = await open(browser, studio.url), other = await open(browser, studio.url);
    for (const one of [page, other]) await is_ready(one);
    check(await page.evaluate(() => !window.studio.store.hello.recording), 'nothing is shown yet');
    const ask = (name, args) => page.evaluate(([n, a]) => window.studio.wire.request(n, a).then(({ result }) => result, (error) => error.message), [name, args]);
    for (const bad of ['/etc/passwd', '../../etc/passwd', 'nosuch.mcap', '.', '']) check((await ask('open_recording', { file: bad })).includes('in the folder that rtm-studio was started in'), `${bad}: ${await ask('open_recording', { file: bad })}`);
    writeFileSync(join(rig.work, 'none.mcap'), 'hello');
    check((await ask('open_recording', { file: 'none.mcap' })).includes('none.mcap'), 'no recording');
    await page.locator('#open-recording').click();
    await page.locator('#recordings button.link', { hasText: /^run\.mcap$/ }).click();
    for (const one of [page, other]) {
      await has_world(one);
      await until('it is shown', () => one.evaluate(() => window.studio.store.hello.recording?.file === 'run.mcap' && window.studio.store.system.components.length === 3));
    }
    await scrub(page, 9);
    await scrub(other, 2);
    await until('two places', async () => !near(await robot(page), await robot(other)));
    await becomes(() => page.locator('footer .command').textContent(), 'rtm-studio run.mcap', 'the command');
    await page.keyboard.press('r');
    await page.locator('#close-recording').click();
    for (const one of [page, other]) {
      await until('it is closed', () => one.evaluate(() => !window.studio.store.hello.recording && window.studio.store.system.components.length === 0));
      await until('there is a now', async () => one.locator('#live').isVisible());
      same(one.problems, [], 'problems');
      await one.context().close();
    }
    await rig.end(studio);
    const shut = await rig.studio('--read-only');
    const looker = await open(browser, shut.url);
    await is_ready(looker);
    const said = await looker.evaluate(() => window.studio.wire.request('open_recording', { file: 'run.mcap' }).then(() => 'done', (error) => error.message));
    check(said.includes('read-only'), said);
    await looker.locator('#open-recording').click();
    await until('it says so', async () => (await looker.locator('#recordings').textContent()).includes('read-only'));
    await looker.context().close();
    await rig.end(shut);
  }],
  ['a failed row of a campaign leads to its recording, in which a component is replayed', async ({ rig, browser }) => {
    const plan = ['system: ' + join(worlds, 'systems/obstacle_avoidance.xml'), 'world: ' + join(worlds, 'obstacle_course.sdf'), 'duration: 3', `module_path: ${lib}`,
      'expect:', '  - path_length: {model: pioneer2dx, min: 0.5}', 'vary:', '  component/LaserObstacleAvoid0/speed_gain: [0.0001, 0.001]'];
    writeFileSync(join(rig.work, 'plan.yaml'), plan.join('\n') + '\n');
    const failed = await rig.call('rtse', 'sweep', 'plan.yaml', '--record').then(() => false, (error) => error.code === 1);
    check(failed, 'a row fails');
    const studio = await rig.studio();
    const page = await open(browser, studio.url);
    await is_ready(page);
    await page.locator('#open-recording').click();
    await page.locator('#campaigns button', { hasText: 'plan.db' }).click();
    await until('its rows', async () => (await page.locator('.campaign tbody tr').count()) === 2);
    await becomes(() => page.locator('dialog[open] [role=status]').textContent(), '2 rows: 1 passed, 1 failed', 'summary');
    await page.locator('.campaign td.failed button').click();
    await until('the recording', () => page.evaluate(() => window.studio.store.hello.recording?.file === 'run.mcap' && window.studio.store.system.components.length === 3));
    await choose(page, 'component', await path_of(page, 'LaserObstacleAvoid0'));
    await page.locator('#replay').click();
    await page.locator('#replayed', { hasText: 'equal' }).waitFor();
    const ask = (name, args) => page.evaluate(([n, a]) => window.studio.wire.request(n, a).then(({ result }) => JSON.stringify(result), (error) => error.message), [name, args]);
    check((await ask('replay', { component: 'Nobody0' })).includes('Nobody0'), 'no such component');
    check((await ask('campaign', { file: '../../etc/passwd' })).includes('in the folder that rtm-studio was started in'), 'another file');
    writeFileSync(join(rig.work, 'none.db'), 'hello');
    check((await ask('campaign', { file: 'none.db' })).includes('none.db'), 'no campaign');
    same(page.problems, [], 'problems');
    await page.context().close();
    await rig.end(studio);
  }],
  ['depth and raw pictures are seen, live and recorded', async ({ rig, browser }) => {
    const world = await rig.server('tests/worlds/every_device.sdf');
    const studio = await rig.studio();
    const page = await open(browser, studio.url);
    await is_ready(page);
    await has_world(page);
    await page.locator('#tab-images').click();
    const seen = () => until('both pictures', () => page.evaluate(() => [...document.querySelectorAll('.images img')].filter((image) => image.complete && image.naturalWidth > 8).length === 2));
    await page.locator('.images button', { hasText: /^rig::eyes$/ }).click();
    await page.evaluate(() => window.studio.bottom.show_image('depth:rig::eyes'));
    await seen();
    await rig.call('rtse', '--ns', rig.names, 'record', '--views', '--raw-pictures', '-o', join(rig.work, 'raw.mcap'), '-t', '1', '-s', String(rig.server_id));
    await page.evaluate(() => { for (const image of document.querySelectorAll('.images img')) image.removeAttribute('src'); });
    await page.evaluate(() => window.studio.wire.request('open_recording', { file: 'raw.mcap' }));
    await until('it is shown', () => page.evaluate(() => window.studio.store.hello.recording?.file === 'raw.mcap'));
    await scrub(page, await page.evaluate(() => window.studio.store.hello.recording.to));
    await seen();
    same(page.problems, [], 'problems');
    await page.context().close();
    await rig.end(studio);
    await rig.end(world);
  }],
  ['models that came and went are seen when they were there, and actors where they were', async ({ rig, browser }) => {
    const file = join(rig.work, 'late.sdf');
    const box = '<geometry><box><size>0.4 0.4 0.4</size></box></geometry>';
    writeFileSync(file, readFileSync(join(source, 'tests/worlds/followers.sdf'), 'utf8').replaceAll('models/crate', join(source, 'tests/worlds/models/crate'))
      .replace('<real_time_factor>0<', '<real_time_factor>1<').replace('<model name="ball">', `<model name="first"><static>true</static><pose>4 4 0.2 0 0 0</pose><link name="l"><visual name="v">${box}</visual></link></model><model name="ball">`));
    const world = await rig.server(relative(source, file), '-u');
    // The recorder looks for models by the wall clock, and says what it finds: a second is enough.
    const at = (seconds) => rig.simctl('step', String(seconds * 250), '--paced');
    const recorder = rig.start('rtse', ['--ns', rig.names, 'record', '--views', '-o', join(rig.work, 'late.mcap'), '-s', String(rig.server_id)]);
    const size = () => statSync(join(rig.work, 'late.mcap')).size;
    await until('it records', async () => size() > 1000);
    await at(1);
    await rig.simctl('spawn', join(source, 'tests/worlds/models/crate/model.sdf'), '--name', 'late', '--pose', '1 3 2');
    await at(3);
    await rig.simctl('delete', 'first');
    await at(3);
    await rig.end(recorder, 'SIGINT');
    await rig.end(world);
    const studio = rig.start('rtm-studio', [join(rig.work, 'late.mcap'), '-p', '0', ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : [])]);
    const page = await open(browser, await until('rtm-studio', () => /http:\/\/\S+/.exec(studio.log())?.[0]));
    await is_ready(page);
    await has_world(page);
    const seen = () => page.evaluate(() => {
      const { models } = window.studio.world.world;
      return ['first', 'late'].filter((name) => models.get(name)?.group.visible).join(' ');
    });
    const place = (name) => page.evaluate((wanted) => window.studio.world.world.links.find((link) => link.name === wanted)?.getWorldPosition(window.studio.world.eye.target.clone()).toArray(), name);
    // If the recorder started late, the recording begins later, and earlier times cannot be selected.
    const { from, to } = await page.evaluate(() => window.studio.store.hello.recording);
    check(from < 0.9 && to > 6.9, `recorded from ${from} to ${to}`);
    // Back, too: what has come is gone again, and what has gone is there.
    for (const [time, wanted] of [[0.9, 'first'], [3.8, 'first late'], [6.8, 'late'], [0.95, 'first'], [3.9, 'first late']]) {
      await scrub(page, time);
      await until(`${wanted} at ${time} s`, async () => (await seen()) === wanted);
      await becomes(() => page.evaluate(() => window.studio.store.world.models.map((m) => m.name).filter((n) => n === 'first' || n === 'late').sort().join(' ')), wanted, 'tree');
    }
    const [link] = await page.evaluate(() => window.studio.world.world.models.get('late').links.map((one) => one.name));
    await until('it falls to where it was', async () => { const [x, y, z] = await place(link); return Math.abs(x - 1) < 0.2 && Math.abs(y - 3) < 0.2 && z < 2; });
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'late-model.png') });
    const walked = async (time) => { await scrub(page, time); await until('the actor', async () => Math.abs((await place('person'))[1] - time) < 0.1); };
    await walked(2.5);
    await walked(1.5);
    same(page.problems, [], 'problems');
    await page.context().close();
    await rig.end(studio);
  }],
  ['files that are none, damaged or without a world', async ({ rig, file, browser }) => {
    const bad = join(rig.work, 'bad.mcap'), cut = join(rig.work, 'cut.mcap');
    writeFileSync(bad, 'hello');
    const refused = async (...words) => promisify(execFile)(join(bin, 'rtm-studio'), [...words, '-p', '0'], { timeout: watchdog }).then(() => 'it took it', (error) => error.stderr);
    for (const line of [await refused(bad), await refused(file, '--world', join(worlds, 'empty.sdf')), await refused(join(worlds, 'systems/obstacle_avoidance.xml'))]) {
      check(line.startsWith('rtm-studio: ') && line.trim().split('\n').length === 1, line);
    }
    const octets = readFileSync(file);
    writeFileSync(cut, octets.subarray(0, Math.floor(octets.length * 0.6)));
    const studio = rig.start('rtm-studio', [cut, '-p', '0', ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : [])]);
    const page = await open(browser, await until('rtm-studio', () => /http:\/\/\S+/.exec(studio.log())?.[0]));
    await has_world(page);
    await until('it says so', async () => (await page.locator('.link-state').textContent()).includes('damaged'));
    const to = await page.evaluate(() => window.studio.store.hello.recording.to);
    check(to > 1 && to < 12, `to ${to}`);
    await scrub(page, to);
    same(page.problems, [], 'problems');
    await page.context().close();
    await rig.end(studio);
  }],
];

run([...flows.slice(0, 2), ...recorded_flows, ...flows.slice(2)], set_up, async (shared) => shared?.rig.end_all());
