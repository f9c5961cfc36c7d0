// The page in front of the real programs: naming service, simulator, components, rtm-studio. system_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
// Flows follow each other in one system: each begins with what the one before has left.
import { execFile } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { becomes, check, has_world, is_ready, open, run, same, until } from './rig.mjs';
import { flows as robot_flows } from './robot_steps.mjs';
import { boxes, choose, drag, drives, edges, in_state, path_of, robot, set_up } from './system_rig.mjs';

const flows = [
  ['a token that is wrong shows and does nothing', async ({ studio, browser }) => {
    const { origin } = new URL(studio.url);
    for (const path of ['/world.glb', '/access', '/world.glb?token=wrong']) {
      for (const headers of [{}, { Authorization: 'Bearer wrong' }]) {
        const reply = await fetch(`${origin}${path}`, { headers });
        check([401, 403].includes(reply.status), `${path}: ${reply.status}`);
        check(!(await reply.text()).includes('glTF'), 'no world');
      }
    }
    for (const [end, wanted] of [['/', 'no token'], [`/#token=${'0'.repeat(32)}`, 'wrong token']]) {
      const page = await open(browser, `${origin}${end}`);
      await until(wanted, async () => (await page.locator('.link-state').textContent()).includes(wanted));
      same(await page.locator('.diagram .box').count(), 0, 'boxes');
      check(await page.evaluate(() => !window.studio.store.hello && !window.studio.store.world), 'it knows nothing');
      await page.context().close();
    }
  }],
  // Each port of a host gets the cookies of all.
  ['the token stays in the tab: no cookie, nothing in the address, and nothing for another port', async ({ page, studio }) => {
    const token = new URL(studio.url).hash.slice('#token='.length);
    check(/^[0-9a-f]{32}$/.test(token), studio.url);
    same(await page.context().cookies(), [], 'cookies');
    check(!(await page.evaluate(() => location.href)).includes(token), 'not in the address bar');
    check(!(await page.evaluate(() => JSON.stringify(localStorage))).includes(token), 'not on the disk');
    const heard = [];
    const neighbour = createServer((request, reply) => {
      heard.push(JSON.stringify([request.url, request.headers]));
      reply.setHeader('Access-Control-Allow-Origin', '*');
      reply.end('<!doctype html><title>neighbour</title>');
    });
    await new Promise((resolve) => neighbour.listen(0, '127.0.0.1', resolve));
    const other = await page.context().newPage();
    await other.goto(`http://127.0.0.1:${neighbour.address().port}/`);
    const seen = await other.evaluate(async (origin) => {
      const asks = new BroadcastChannel('rtm-studio-token');
      let heard = '';
      asks.onmessage = ({ data }) => { heard += JSON.stringify(data); };
      asks.postMessage('who has it?');
      const reply = await fetch(`${origin}/world.glb`, { credentials: 'include' }).then((r) => r.text(), () => 'refused');
      const opened = await new Promise((resolve) => {
        const socket = new WebSocket(`${origin.replace('http', 'ws')}/ws`, ['rtmsim.studio.v1']);
        socket.onopen = () => resolve('open');
        socket.onclose = () => resolve('refused');
      });
      return [reply, opened, heard, JSON.stringify(sessionStorage)];
    }, new URL(studio.url).origin);
    same(seen, ['refused', 'refused', '', '{}'], 'what a page of another port gets');
    check(heard.length > 0 && heard.every((one) => !one.includes(token)), heard.join('\n'));
    await other.close();
    neighbour.close();
  }],
  ['it is there again after a reload, in another tab and by a copied link', async ({ page, browser, studio }) => {
    await page.reload();
    await is_ready(page);
    await has_world(page);
    await boxes(page, 3);
    const tab = await page.context().newPage();
    await tab.goto(page.url());
    await is_ready(tab);
    await tab.close();
    await page.evaluate(() => Object.assign(navigator.clipboard, { writeText: async (text) => { window.copied = text; } }));
    await page.locator('#copy-link').click();
    const link = await until('the link', () => page.evaluate(() => window.copied));
    const elsewhere = await open(browser, link);
    await is_ready(elsewhere);
    check(!(await elsewhere.evaluate(() => location.href)).includes('token='), 'the token leaves the address bar');
    // A new URL of the same page: the browser changes what is behind the '#' alone.
    await elsewhere.evaluate(() => { window.is_old = true; });
    await elsewhere.goto(studio.url);
    await elsewhere.waitForFunction(() => !window.is_old);
    await is_ready(elsewhere);
    await elsewhere.context().close();
  }],
  ['words of a shell are read back by bash, and hold printable ASCII only', async ({ page }) => {
    const words = ['', 'plain', "it's", '\\', '$(id)', '`id`', '!!', "!$ it's", '\x1b[201~\nid\n', '\r\t\x7f', '\x01ff', '=ls', '%1', '~', '{a,b}', '*', '-rf', 'caf\u00e9', '\u65e5\u672c', '\u202egpj.exe', '\u009b31m', '\u2028', '\u{1f916}', 'a=b', '"'];
    const line = await page.evaluate((all) => window.studio.shell_line(all), words);
    check(/^[ -~]*$/.test(line), line);
    const { stdout } = await promisify(execFile)('bash', ['-c', `set -o history -o histexpand\nprintf '%s\\0' ${line}`], { encoding: 'buffer' });
    same(stdout.toString('utf8').split('\0').slice(0, -1), words, 'words');
  }],
  ['the world and the system are there', async ({ page }) => {
    await becomes(async () => (await page.locator('.diagram .box .name').allTextContents()).sort(), ['LaserObstacleAvoid0', 'RTCLaser0', 'RTCPosition2d0'], 'boxes');
    await in_state(page, 'inactive', 3);
    await becomes(() => page.locator('.top .what').textContent(), 'obstacle_course', 'name of the world');
    await becomes(() => page.locator('.tree li[data-key="model:pioneer2dx"]').count(), 1, 'robot in the tree');
  }],
  ['wired by mouse from nothing, the robot moves', async ({ page, rig }) => {
    await drag(page, 'RTCLaser0:range', 'LaserObstacleAvoid0:range');
    await edges(page, 1);
    await drag(page, 'LaserObstacleAvoid0:velocity', 'RTCPosition2d0:velocity');
    await edges(page, 2);
    await page.locator('#activate-all').click();
    await in_state(page, 'active', 3);
    await drives(rig);
    const x = () => page.evaluate((name) => window.studio.world.world.models.get(name).canonical.position.toArray(), robot);
    const before = await x();
    await until('it moves in the page', async () => { const now = await x(); return Math.hypot(now[0] - before[0], now[1] - before[1]) > 0.05; });
  }],
  ['the page shows where the robot is', async ({ page, rig }) => {
    await page.locator('#run').click();
    await until('paused', () => page.evaluate(() => window.studio.store.time?.paused));
    const pose = JSON.parse(await rig.simctl('--json', 'pose', `${robot}::chassis`));
    await until('the same place', () => page.evaluate(([name, p, q]) => {
      const { position, quaternion } = window.studio.world.world.models.get(name).canonical;
      return Math.hypot(position.x - p[0], position.y - p[1], position.z - p[2]) < 2e-3 && Math.abs(quaternion.w * q[0] + quaternion.x * q[1] + quaternion.y * q[2] + quaternion.z * q[3]) > 0.9999;
    }, [robot, pose.position, pose.orientation]));
  }],
  ['step, run and speed', async ({ page, rig }) => {
    const steps = async () => JSON.parse(await rig.simctl('--json', 'stats')).steps;
    const before = await steps();
    await page.locator('.world canvas').focus();
    await page.keyboard.press('.');
    await until('a step', async () => (await steps()) > before);
    check(await page.evaluate(() => window.studio.store.time?.paused), 'still paused');
    await page.locator('#speed').fill('3');
    await page.keyboard.press('Enter');
    await page.locator('.world canvas').focus();
    await page.keyboard.press('Space');
    await until('runs', () => page.evaluate(() => !window.studio.store.time?.paused && window.studio.store.time.rtf_wanted === 3));
    await page.locator('#speed').fill('1');
    await page.keyboard.press('Enter');
    await until('real time again', () => page.evaluate(() => window.studio.store.time?.rtf_wanted === 1));
  }],
  ['what was done to all is undone for all, by a key too', async ({ page }) => {
    await page.locator('#deactivate-all').click();
    await in_state(page, 'inactive', 3);
    await page.keyboard.press('Control+z');
    await in_state(page, 'active', 3);
    await choose(page, 'RTCLaser0');
    await page.keyboard.press('d');
    await in_state(page, 'active', 2);
    await page.keyboard.press('Control+z');
    await in_state(page, 'active', 3);
    await edges(page, 2);
  }],
  ['the command of an act does the same', async ({ page, rig }) => {
    await page.locator('#deactivate-all').click();
    await in_state(page, 'inactive', 3);
    await choose(page, 'RTCLaser0');
    await page.locator('#act-activate').click();
    await in_state(page, 'active', 1);
    const command = await until('command', async () => { const text = await page.locator('footer .command').textContent(); return /^rtse .* act /.test(text) && text; });
    await rig.rtse('deact', 'RTCLaser0');
    await in_state(page, 'inactive', 3);
    await rig.call('rtse', ...command.split(' ').slice(1));
    await in_state(page, 'active', 1);
  }],
  ['a connection is cut and comes back by undo', async ({ page, rig }) => {
    const id = await until('a connection', () => page.evaluate(() => window.studio.store.system.connections[0]?.id));
    await page.evaluate((c) => window.studio.select({ kind: 'connection', id: c }), id);
    await page.locator('#disconnect').click();
    await edges(page, 1);
    await page.keyboard.press('Control+z');
    await edges(page, 2);
    void rig;
  }],
  ['a parameter is set, a wrong one refused', async ({ page, rig }) => {
    await choose(page, 'LaserObstacleAvoid0');
    const field = page.locator('.inspector label:has-text("max_turn") + *').first();
    await field.waitFor();
    await field.fill('55');
    await page.keyboard.press('Tab');
    await until('set', async () => (await rig.rtse('conf', 'LaserObstacleAvoid0', 'get', 'max_turn')).trim() === '55');
    await field.fill('many');
    await page.keyboard.press('Tab');
    await until('refused', async () => (await page.locator('footer.failed').count()) === 1);
  }],
  ['contexts have a rate, stop and start, and rtse does the same', async ({ page, rig }) => {
    const context = async () => JSON.parse(await rig.rtse('--json', 'ec', 'LaserObstacleAvoid0'))[0];
    const told = (words) => until(`rtse ${words}`, async () => (await page.locator('footer .command').textContent()).endsWith(words));
    await choose(page, 'LaserObstacleAvoid0');
    const { rate } = await context();
    await page.locator('#rate-0').fill('25');
    await page.keyboard.press('Tab');
    await until('25 Hz', async () => (await context()).rate === 25);
    await told('LaserObstacleAvoid0.rtc rate 25');
    await page.locator('#context-0').click();
    await until('stopped', async () => !(await context()).running);
    await told('LaserObstacleAvoid0.rtc stop');
    await until('the page knows', async () => (await page.locator('#context-0').textContent()) === 'Start');
    await rig.rtse('ec', 'LaserObstacleAvoid0', 'start');
    await rig.rtse('ec', 'LaserObstacleAvoid0', 'rate', String(rate), '-e', '0');
    same({ ...(await context()), state: '' }, { index: 0, owned: true, kind: 'PERIODIC', rate, running: true, state: '', problem: '' }, 'by rtse');
    const refused = await rig.rtse('ec', 'LaserObstacleAvoid0', 'stop', '-e', '7').then(() => 'it took it', (error) => error.stderr);
    check(refused.includes('has no execution context number 7'), refused);
  }],
  ['the error state is seen, and reset', async ({ page, rig }) => {
    await page.locator('#deactivate-all').click();
    await in_state(page, 'inactive', 3);
    await rig.rtse('conf', 'RTCLaser0', 'set', 'device_id', 'pioneer2dx::lazer');
    await choose(page, 'RTCLaser0');
    await page.locator('#act-activate').click();
    await in_state(page, 'error', 1);
    await page.locator('#tab-logs').click();
    const line = page.locator('.log > .level-error', { hasText: 'lazer' }).first();
    await until('its log says why', async () => (await line.locator('.source').textContent()) === 'RTCLaser0');
    await page.locator('input[aria-label="Filter logs"]').fill('nothing of the kind');
    await until('filtered', async () => (await page.locator('.log > div').count()) === 0);
    await page.locator('input[aria-label="Filter logs"]').fill('');
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'error-log.png') });
    await page.locator('#tab-plots').click();
    await rig.rtse('conf', 'RTCLaser0', 'set', 'device_id', 'pioneer2dx::laser');
    await page.locator('#act-reset').click();
    await in_state(page, 'inactive', 3);
  }],
  ...robot_flows,
  ['a manager creates a component and deletes it', async ({ page }) => {
    const manager = await until('manager', () => page.evaluate(() => window.studio.store.system.managers[0]?.path));
    await page.evaluate((id) => window.studio.select({ kind: 'manager', id }), manager);
    await page.locator('#manager-create').click();
    await page.locator('#ask-text').fill('LaserObstacleAvoid?instance_name=Second');
    await page.keyboard.press('Enter');
    await boxes(page, 4);
    await choose(page, 'Second');
    await page.locator('#act-exit').click();
    await boxes(page, 3);
    await page.evaluate((id) => window.studio.select({ kind: 'manager', id }), manager);
    await page.locator('.inspector li', { hasText: /^RTCLaser$/ }).locator('button[aria-label="Create RTCLaser"]').click();
    await boxes(page, 4);
    await page.locator('.inspector button[aria-label="Delete RTCLaser1"]').click();
    await boxes(page, 3);
  }],
  ['a signal has members before its first sample, then a rate; a value is written by hand', async ({ page, rig }) => {
    const signal = (name) => until(name, () => page.evaluate((end) => window.studio.store.signals.find((x) => x.kind === 'port' && x.topic.endsWith(end))?.topic, name));
    const velocity = await signal('LaserObstacleAvoid0/velocity');
    await page.evaluate((id) => window.studio.select({ kind: 'signal', id }), velocity);
    await page.locator('.inspector button[aria-label="Plot data.vx"]').waitFor();
    const { zero } = await page.evaluate((topic) => window.studio.wire.request('members', { topic }).then(({ result }) => result), velocity);
    same(zero, { tm: { sec: 0, nsec: 0 }, data: { vx: 0, vy: 0, va: 0 } }, 'zeros');
    const error = await page.evaluate(() => window.studio.wire.request('members', { topic: '/nobody.rtc:x' }).then(() => 'done', (e) => e.message));
    check(error.includes('nobody'), error);
    await choose(page, 'RTCPosition2d0');
    await page.locator('#act-disconnect_all').click();
    await edges(page, 1);
    await page.locator('#act-activate').click();
    await in_state(page, 'active', 1);
    await page.evaluate((id) => window.studio.select({ kind: 'port', id }), `${await path_of(page, 'RTCPosition2d0')}:velocity`);
    await page.locator('#inject').click();
    await until('zeros', async () => (await page.locator('#inject-value').inputValue()).includes('"vx": 0'));
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'inject.png') });
    const place = async () => JSON.parse(await rig.simctl('--json', 'pose', robot)).position, was = await place();
    await page.locator('#inject-value').fill('{"data": {"vx": 0.2}}');
    await page.locator('dialog[open] button.main').click();
    await until('it was written', async () => (await page.locator('footer .command').textContent()).includes(' inject '));
    await until('the robot has driven, however short', async () => { const [x, y] = await place(); return Math.hypot(x - was[0], y - was[1]) > 0.01; });
    const odometry = await signal('RTCPosition2d0/odometry');
    await page.evaluate((id) => window.studio.select({ kind: 'signal', id }), odometry);
    await until('its rate', async () => /^\d.* a second, \d.* ms after its stamp$/.test(await page.locator('.inspector .rate').textContent()));
    await page.locator('#tab-step').click();
    await until('what its context has done', async () => (await page.locator('.contexts tbody tr', { hasText: 'RTCPosition2d0' }).locator('td').nth(1).textContent()).endsWith(' Hz'));
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'step.png') });
    const says = (instance) => page.locator('.contexts tbody tr', { hasText: instance }).locator('td').last().textContent();
    await until('who is inactive waits for nothing', async () => (await says('RTCLaser0')) === 'inactive' && (await says('RTCPosition2d0')) !== 'inactive');
    await page.locator('#tab-plots').click();
    await choose(page, 'RTCPosition2d0');
    await page.locator('#act-deactivate').click();
    await in_state(page, 'inactive', 3);
    await drag(page, 'LaserObstacleAvoid0:velocity', 'RTCPosition2d0:velocity');
    await edges(page, 2);
  }],
  ['a picture of the view is that of the simulator', async ({ page, rig }) => {
    const [saved] = await Promise.all([page.waitForEvent('download'), page.locator('button[aria-label^="Save an image"]').click()]);
    const png = readFileSync(await saved.path());
    const box = await page.evaluate(() => { const { clientWidth, clientHeight } = window.studio.world.element; return [clientWidth, clientHeight]; });
    same([png.toString('latin1', 1, 4), png.readUInt32BE(16), png.readUInt32BE(20)], ['PNG', ...box], 'picture');
    if (process.env.STUDIO_PICTURES) writeFileSync(join(process.env.STUDIO_PICTURES, 'saved.png'), png);
    // The command draws the same.
    const command = await until('the command', async () => { const text = await page.locator('footer .command').textContent(); return text.includes(' screenshot ') && text; });
    const words = [...command.matchAll(/'([^']*)'|(\S+)/g)].map(([, quoted, bare]) => quoted ?? bare);
    await rig.call('simctl', ...words.slice(1));
    same([readFileSync(join(rig.work, 'world.png')).readUInt32BE(16)], [box[0]], 'its picture');
    // From above, too, wherever its middle is.
    await rig.simctl('pause');
    await page.evaluate(() => { const { world } = window.studio; world.top(); world.eye.target.set(2, 1, 0); world.eye.span = 5; world.redraw(); });
    const [from_above] = await Promise.all([page.waitForEvent('download'), page.locator('button[aria-label^="Save an image"]').click()]);
    const told = await until('its command', async () => { const text = await page.locator('footer .command').textContent(); return text.includes('--top') && text; });
    await rig.call('simctl', ...[...told.matchAll(/'([^']*)'|(\S+)/g)].map(([, quoted, bare]) => quoted ?? bare).slice(1));
    check(readFileSync(join(rig.work, 'world.png')).equals(readFileSync(await from_above.path())), `not the same picture: ${told}`);
    await page.evaluate(() => window.studio.world.whole());
    await rig.simctl('run');
  }],
  ['saved, torn down and opened again', async ({ page, rig }) => {
    const at = () => page.evaluate(() => Object.fromEntries(Object.entries(window.studio.diagram.positions()).map(([path, [x, y]]) => [path, [x, y]])));
    const before = await at();
    await page.evaluate((moved) => window.studio.diagram.place_all(moved),
                        Object.fromEntries(Object.entries(before).map(([path, [x, y]], i) => [path.slice(1), [x + 30 + i, y - 40]])));
    const placed = await until('boxes are where they were put', async () => { const now = await at(); return Object.entries(before).every(([path, [, y]]) => now[path][1] === y - 40) && now; });
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#save').click()]);
    const file = join(rig.work, 'saved.xml');
    writeFileSync(file, readFileSync(await download.path()));
    same([...readFileSync(file, 'utf8').matchAll(/<rtsExt:Location rtsExt:x="(-?\d+)" rtsExt:y="(-?\d+)"/g)].map(([, x, y]) => [Number(x), Number(y)]).sort(), Object.values(placed).sort(), 'places in the file');
    await page.evaluate(() => window.studio.diagram.arrange());
    const choose_way = async (way) => {
      await page.locator('input[type=file]').setInputFiles(file);
      await page.locator('dialog[open] .way', { has: page.locator(`strong:text-is("${way}")`) }).click();
      if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'profile.png') });
      await page.locator('dialog[open] button.main').click();
    };
    await choose_way('Compare');
    await page.locator('dialog[open] p', { hasText: 'What runs is what was saved' }).waitFor();
    await page.locator('dialog[open] button.main').click();
    await choose_way('Tear down');
    await edges(page, 0);
    await choose_way('Compare');
    await until('what is missing', async () => (await page.locator('.differences li', { hasText: 'range' }).count()) > 0);
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'compared.png') });
    await page.locator('dialog[open] button.main').click();
    await choose_way('Load');
    await edges(page, 2);
    await until('boxes are where they were saved', async () => JSON.stringify(await at()) === JSON.stringify(placed));
    await page.locator('#activate-all').click();
    await in_state(page, 'active', 3);
    await drives(rig);
  }],
  ['two viewers see the same', async ({ browser, page, studio }) => {
    const other = await open(browser, studio.url);
    await is_ready(other);
    await boxes(other, 3);
    await in_state(other, 'active', 3);
    await page.locator('#deactivate-all').click();
    await in_state(other, 'inactive', 3);
    await other.locator('#activate-all').click();
    await in_state(page, 'active', 3);
    await other.context().close();
  }],
  ['a component dies and comes back', async ({ page, rig, ...shared }) => {
    await rig.end(shared.host, 'SIGKILL');
    await until('the page tells', async () => (await page.locator('.diagram .box').count()) === 0 || (await page.locator('.diagram .box.state-unknown').count()) === 3);
    await page.locator('#forget-dead').click();
    await boxes(page, 0);
    await until('no names', async () => !(await rig.rtse('ls')).includes('RTCLaser0'));
    await page.locator('#forget-dead').waitFor({ state: 'hidden' });
    shared.host = rig.host(rig.device('RTCLaser'), rig.device('RTCPosition2d'), 'LaserObstacleAvoid');
    await in_state(page, 'inactive', 3);
    await boxes(page, 3);
  }],
  ['the simulator dies and comes back', async (shared) => {
    const { page, rig } = shared;
    await rig.end(shared.world, 'SIGKILL');
    await until('the page tells', async () => (await page.locator('.world .card').textContent()).includes('sim-server'));
    shared.world = await rig.server('worlds/obstacle_course.sdf', '-u');
    await until('the page shows it', async () => (await page.locator('.world .card').count()) === 0);
    await until('its time', () => page.evaluate(() => window.studio.store.time?.sim_time < 1 && window.studio.store.time?.paused));
  }],
  ['the simulator comes back with a wall that is higher, in a world of the same name', async (shared) => {
    const { page, rig } = shared;
    const highest = () => page.evaluate(() => window.studio.world.bounds.max.z);
    const was = await highest(), version = await page.evaluate(() => window.studio.world.world.version);
    const edited = join(rig.work, 'edited.sdf');
    writeFileSync(edited, readFileSync(join(rig.source, 'worlds/obstacle_course.sdf'), 'utf8').replaceAll('12.15 0.15 0.6', '12.15 0.15 2.6'));
    await rig.end(shared.world);
    shared.world = await rig.server(edited, '-u', '--resource-path', join(rig.source, 'worlds/models'));
    await until('the higher wall', async () => (await highest()) > was + 0.5);
    same(await page.evaluate(() => window.studio.world.world.version), version, 'version');
  }],
  ['the naming service dies and comes back', async (shared) => {
    const { page, rig } = shared;
    await rig.end(shared.names, 'SIGKILL');
    await until('the page tells', async () => (await page.locator('.diagram .card').textContent()).includes(rig.names));
    shared.names = await rig.naming();
    await boxes(page, 3);
  }],
  ['rtm-studio dies and comes back', async (shared) => {
    const { page, rig } = shared;
    const url = new URL(shared.studio.url);
    await rig.end(shared.studio, 'SIGKILL');
    await until('the page tells', () => page.evaluate(() => window.studio.wire.status === 'lost'));
    await until('says so', async () => (await page.locator('.link-state').textContent()).includes('exited'));
    // With the same port and the token that this page has.
    shared.studio = await rig.studio('-p', url.port);
    await until('another token: it asks for the new URL', () => page.evaluate(() => window.studio.wire.status !== 'open'));
  }],
  ['read-only: it may look, not act', async ({ browser, rig }) => {
    const studio = await rig.studio('--read-only');
    const page = await open(browser, studio.url);
    await is_ready(page);
    await has_world(page);
    await until('run is off', () => page.locator('#run').isDisabled());
    const error = await page.evaluate(() => window.studio.wire.request('run').then(() => 'done', (e) => e.message));
    check(error.includes('read-only'), error);
    await page.context().close();
    await rig.end(studio);
  }],
];

run(flows, set_up, async (shared) => shared?.rig.end_all());
