// The page alone, in front of a stand-in of the server: page_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page, flow after flow.
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { component, demo_system, fleet, hello, many_components, Mock, poses, time, world_of } from './mock.mjs';
import { answer, asked, avoid, built, choose, detail, glb, host, laser, set_up } from './mock_page.mjs';
import { becomes, check, drawn, has_world, is_ready, open, run, same, until } from './rig.mjs';

const axe = createRequire(import.meta.url).resolve('axe-core/axe.min.js');

const flows = [
  ['the page is small', async () => {
    const files = [join(built, 'index.html'), ...readdirSync(join(built, 'assets')).map((f) => join(built, 'assets', f))];
    const size = files.reduce((sum, f) => sum + gzipSync(readFileSync(f)).length, 0);
    check(size <= 300000, `${size} bytes compressed`);
    console.log(`      ${size} bytes compressed, ${files.reduce((sum, f) => sum + statSync(f).size, 0)} plain`);
  }],
  ['no request leaves the machine', async ({ page, url }) => {
    const hosts = await page.evaluate(() => performance.getEntriesByType('resource').map((e) => e.name));
    check(hosts.every((h) => h.startsWith(`${new URL(url).origin}/`) || h.startsWith('data:') || h.startsWith('blob:')), hosts.join(' '));
  }],
  ['the world is seen with its laser fan and names', async ({ page }) => {
    await until('a scan', () => page.evaluate(() => [...window.studio.world.world.links].some((l) => { let n = 0; l.traverse((p) => { n += p.userData.overlay && p.geometry.getAttribute('position')?.count > 50 ? 1 : 0; }); return n > 0; })));
    await becomes(() => page.locator('.labels span').allTextContents(), ['pioneer2dx'], 'names');
  }],
  ['poses move the robot', async ({ page, mock, world }) => {
    const index = await page.evaluate(() => window.studio.world.world.links.findIndex((l) => l.name === 'pioneer2dx::chassis'));
    const before = await page.evaluate(() => window.studio.world.frames);
    mock.say(poses(world.version, [[index, 1, 2, 0.1]]));
    await until('the robot is there', () => page.evaluate(([i, f]) => { const p = window.studio.world.world.links[i].position; return Math.abs(p.x - 1) < 1e-3 && Math.abs(p.y - 2) < 1e-3 && window.studio.world.frames > f; }, [index, before]));
  }],
  ['a click on the robot selects it everywhere', async ({ page }) => {
    await page.evaluate(() => window.studio.world.follow('pioneer2dx'));
    await drawn(page);
    await page.evaluate(() => window.studio.world.draw());
    const box = await page.locator('.world canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await until('selection', () => page.evaluate(() => window.studio.store.selection?.id === 'pioneer2dx'));
    await until('its component is marked in the system', async () => (await page.locator(`.box.related[data-path="${laser}"]`).count()) === 1);
    await until('the tree marks it', async () => (await page.locator('.tree li.chosen').textContent()).includes('pioneer2dx'));
    await becomes(() => page.locator('.inspector h2').textContent(), 'pioneer2dx', 'the inspector shows it');
    await until('its signals are marked', async () => (await page.locator('.tree li.related').count()) >= 1);
  }],
  ['all tools of the world are within its panel', async ({ page }) => {
    const bar = await page.locator('.world-panel > .bar').boundingBox();
    const out = () => page.locator('.world-panel > .bar > *').evaluateAll((all, box) => all.map((e) => [e.getAttribute('aria-label') ?? e.textContent, e.getBoundingClientRect()]).filter(([, r]) => r.width > 0 && (r.right > box.x + box.width + 0.5 || r.bottom > box.y + box.height + 0.5)).map(([name]) => name), bar);
    await becomes(out, [], 'cut off');
    check(bar.height < 40, `one row: ${bar.height}`);
  }],
  ['eyes: from above, follow, all', async ({ page }) => {
    await page.locator('.world canvas').focus();
    await page.keyboard.press('t');
    same(await page.evaluate(() => window.studio.world.eye.mode), 'top', 'mode');
    await page.keyboard.press('o');
    same(await page.evaluate(() => window.studio.world.eye.mode), 'orbit', 'mode');
    const before = await page.evaluate(() => window.studio.world.eye.azimuth);
    await page.keyboard.press('ArrowLeft');
    check((await page.evaluate(() => window.studio.world.eye.azimuth)) !== before, 'arrows turn');
    const box = await page.locator('.world canvas').boundingBox();
    await page.mouse.move(box.x + 200, box.y + 60);
    await page.mouse.down();
    await page.mouse.move(box.x + 260, box.y + 90, { steps: 3 });
    await page.mouse.up();
    const distance = await page.evaluate(() => window.studio.world.eye.distance);
    await page.mouse.wheel(0, -300);
    await until('wheel zooms', () => page.evaluate((d) => window.studio.world.eye.distance < d, distance));
  }],
  ['frames are shown by a key, with the names of links', async ({ page }) => {
    await page.locator('.world canvas').focus();
    await page.evaluate(() => { window.studio.select({ kind: 'model', id: 'pioneer2dx' }); window.studio.world.follow('pioneer2dx'); });
    await page.keyboard.press('x');
    const links = await page.evaluate(() => window.studio.world.world.models.get('pioneer2dx').links.length);
    await until('the world and its links', () => page.evaluate((n) => window.studio.world.axes.count === n + 1, links));
    await until('names', async () => (await page.locator('.labels span.frame').count()) > 0);
    await becomes(() => page.locator('button[aria-label^="Frames"]').getAttribute('aria-pressed'), 'true', 'the button');
    await page.keyboard.press('x');
    await until('none', async () => (await page.evaluate(() => window.studio.world.axes.count)) === 0 && (await page.locator('.labels span.frame').count()) === 0);
  }],
  ['a robot is moved by dragging it', async ({ page, mock }) => {
    await page.evaluate(() => { window.studio.select(null); window.studio.world.follow('pioneer2dx'); window.studio.world.hands.set_tool('move'); window.studio.world.draw(); });
    const box = await page.locator('.world canvas').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 4 });
    await page.mouse.up();
    await until('set_pose', () => asked(mock, 'set_pose').length > 0);
    check(asked(mock, 'set_pose').at(-1).args.planar.every(Number.isFinite), 'numbers');
    await page.evaluate(() => window.studio.world.hands.set_tool('push'));
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y, { steps: 4 });
    await page.mouse.up();
    await until('push', () => asked(mock, 'push').length > 0);
    await page.evaluate(() => { window.studio.world.hands.set_tool('push'); window.studio.world.whole(); });
  }],
  ['a model is spawned where the mouse says, on what is there, and turned by a drag', async ({ page, mock }) => {
    await page.evaluate(() => { window.studio.world.top(); window.studio.world.draw(); });
    const spawned = () => asked(mock, 'spawn').length, count = spawned();
    const ask = async () => {
      await page.locator('button[aria-label="Spawn a model"]').click();
      await page.locator('#spawn-model').fill('cow');
      await page.locator('#spawn-place').click();
    };
    const box = await page.locator('.world canvas').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await ask();
    await page.keyboard.press('Escape');
    await ask();
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y - 40, { steps: 3 });
    await page.mouse.up();
    await until('spawned', () => spawned() === count + 1);
    const { pose } = asked(mock, 'spawn').at(-1).args, target = await page.evaluate(() => window.studio.world.eye.target.toArray());
    check(Math.hypot(pose[0] - target[0], pose[1] - target[1]) < 0.2, `under the mouse: ${pose}, ${target}`);
    check(Math.abs(pose[3] - Math.SQRT1_2) < 1e-3 && Math.abs(pose[6] - Math.SQRT1_2) < 1e-3, `towards the north: ${pose}`);
    await until('it is selected', () => page.evaluate(() => window.studio.store.selection?.id === 'cow'));
    await page.mouse.click(x, y);
    same(spawned(), count + 1, 'once');
    await page.evaluate(() => window.studio.world.whole());
  }],
  ['an arrow above the selected model moves it along its axis alone', async ({ page, mock }) => {
    await choose(page, 'model', 'pioneer2dx');
    await page.evaluate(() => { const { world } = window.studio; world.follow('pioneer2dx'); world.draw(); world.eye.set_mode('orbit'); if (world.hands.tool !== 'move') world.hands.set_tool('move'); world.draw(); world.draw(); });
    const before = await page.evaluate(() => window.studio.world.hands.gizmo.pose());
    for (const [axis, i] of [['Z', 2], ['Y', 1]]) {
      const [x, y] = await page.evaluate((a) => window.studio.world.hands.gizmo.handle(a), axis);
      const count = await page.evaluate(() => window.studio.store.acts.length);
      await page.evaluate(() => { window.studio.world.next_draw = Infinity; }); // as where pictures are slow: none between the arrow's choice and the press
      await page.mouse.move(x, y, { steps: 2 });
      await until(`${axis} is under the mouse`, () => page.evaluate(() => window.studio.world.hands.gizmo.is_under_mouse()));
      await page.mouse.down();
      await page.evaluate(() => { window.studio.world.next_draw = 0; });
      await page.mouse.move(x + (axis === 'Z' ? 0 : 30), y - 30, { steps: 4 });
      await page.mouse.up();
      await until('an act', () => page.evaluate((n) => window.studio.store.acts.length > n, count));
      const { pose } = asked(mock, 'set_pose').at(-1).args;
      check(Math.abs(pose[i] - before[i]) > 0.01, `${axis}: ${pose} after ${before}`);
      check([0, 1, 2].every((k) => k === i || Math.abs(pose[k] - before[k]) < 1e-6), `along ${axis} alone: ${pose}, before ${before}`);
      await page.evaluate(() => window.studio.world.draw());
    }
    await page.keyboard.press('Control+z');
    await until('back', () => asked(mock, 'set_pose').at(-1).args.pose?.every((v, k) => Math.abs(v - before[k]) < 1e-6));
    await page.evaluate(() => { window.studio.world.hands.set_tool('move'); window.studio.world.whole(); });
  }],
  ['keys drive the robot, and stop it when they are let go', async ({ page, mock }) => {
    await choose(page, 'model', 'pioneer2dx');
    await page.locator('.world canvas').focus();
    await page.keyboard.press('g');
    await page.keyboard.down('w');
    await until('forward', () => asked(mock, 'drive').some((m) => m.args.velocity[0] > 0.2));
    await page.keyboard.up('w');
    const count = asked(mock, 'drive').length;
    await until('stop', () => asked(mock, 'drive').slice(count).some((m) => m.args.velocity[0] === 0));
    const stick = await page.locator('.stick').boundingBox();
    await page.mouse.move(stick.x + 56, stick.y + 56);
    await page.mouse.down();
    await page.mouse.move(stick.x + 100, stick.y + 56);
    await until('the stick turns', () => asked(mock, 'drive').at(-1).args.velocity[2] < -0.3);
    await page.mouse.up();
    await page.locator('.stick').focus();
    await page.keyboard.press('Escape');
    await until('released', () => asked(mock, 'release').length === 1);
  }],
  ['components are boxes with states, ports and lines', async ({ page }) => {
    await becomes(() => page.locator('.diagram .box .name').allTextContents(), ['RTCLaser0', 'LaserObstacleAvoid0', 'RTCPosition2d0'], 'boxes');
    await becomes(() => page.locator('.diagram .edge').count(), 2, 'lines');
    await becomes(() => page.locator('.diagram .port.wired').count(), 4, 'wired ports');
    await becomes(() => page.locator('.diagram .box.state-active').count(), 3, 'active');
  }],
  ['a state changes its colour and shape', async ({ page, mock }) => {
    const shape = await page.locator(`[data-path="${laser}"] .shape`).getAttribute('d');
    mock.say({ op: 'states', revision: 1, states: { [laser]: 'Error' }, rates: {} });
    await until('error', async () => (await page.locator(`.box.state-error[data-path="${laser}"]`).count()) === 1);
    check((await page.locator(`[data-path="${laser}"] .shape`).getAttribute('d')) !== shape, 'the shape is another one');
    await until('the head says it', async () => (await page.locator('.counts').textContent()).includes('1 in error'));
    await choose(page, 'component', laser);
    await page.locator('#act-reset').click();
    await until('reset', () => asked(mock, 'reset').length === 1);
    mock.say({ op: 'states', revision: 1, states: { [laser]: 'Inactive' }, rates: {} });
    await page.locator('#act-activate').click();
    await until('activate', () => asked(mock, 'activate').at(-1)?.args.path === laser);
    mock.say({ op: 'states', revision: 1, states: { [laser]: 'Active' }, rates: {} });
  }],
  ['a drag from port to port opens the dialog and connects', async ({ page, mock }) => {
    const from = await page.locator(`[data-port="${laser}:range"] > path`).boundingBox(), to = await page.locator(`[data-port="${avoid}:range"] > path`).boundingBox();
    await page.mouse.move(from.x + 4, from.y + 4);
    await page.mouse.down();
    await page.mouse.move(to.x - 30, to.y + 30, { steps: 4 });
    await until('what fits is shown', async () => (await page.locator('.port.fits').count()) >= 1);
    await page.mouse.move(to.x + 4, to.y + 4, { steps: 3 });
    await page.mouse.up();
    await page.locator('dialog[open]').waitFor();
    await page.locator('dialog[open] select[data-key="dataport.subscription_type"]').selectOption('new');
    await until('the command', async () => (await page.locator('dialog[open] .command').textContent()).startsWith('rtse con'));
    await page.locator('dialog[open] button.main').click();
    await until('connect', () => asked(mock, 'connect').length === 1);
    same(asked(mock, 'connect')[0].args.properties, { 'dataport.subscription_type': 'new' }, 'only what is not usual');
    await until('command below', async () => (await page.locator('footer .command').textContent()) === 'rtse con A B');
    await page.keyboard.press('Control+z');
    await until('undo', () => asked(mock, 'disconnect').some((m) => m.args.id === 'new'));
  }],
  ['a connection by keyboard alone', async ({ page, mock }) => {
    const count = asked(mock, 'connect').length;
    await page.keyboard.press('/');
    await page.keyboard.type('RTCLaser0');
    await page.keyboard.press('ArrowDown');
    await until('the tree has the focus', () => page.evaluate(() => document.activeElement.getAttribute('role') === 'treeitem'));
    await page.evaluate(() => { window.studio.select(null); });
    await page.locator('.diagram svg').focus();
    await page.keyboard.press('ArrowRight');
    await until('first box', () => page.evaluate(() => window.studio.store.selection?.kind === 'component'));
    await page.keyboard.press(']');
    await until('port', () => page.evaluate(() => window.studio.store.selection?.kind === 'port'));
    await page.keyboard.press('c');
    await page.locator('dialog[open]').waitFor();
    await page.locator('#connect-to').focus();
    await page.keyboard.press('Enter');
    await page.locator('dialog[open] button.main').focus();
    await page.keyboard.press('Enter');
    await until('connected', () => asked(mock, 'connect').length === count + 1);
    await page.locator('.tree input').fill('');
  }],
  ['a line is selected and deleted, and comes back by undo', async ({ page, mock }) => {
    const count = asked(mock, 'connect').length;
    await choose(page, 'connection', 'a');
    await page.locator('.diagram svg').focus();
    await page.keyboard.press('Delete');
    await until('disconnect', () => asked(mock, 'disconnect').some((m) => m.args.id === 'a'));
    await until('undo is offered', () => page.locator('#undo').isEnabled());
    await page.locator('#undo').click();
    await until('again', () => asked(mock, 'connect').length === count + 1);
  }],
  ['a wire is chosen by a click on it, and Delete cuts it', async ({ page, mock }) => {
    const count = asked(mock, 'disconnect').length;
    await choose(page, 'component', laser);
    const [x, y] = await page.evaluate(() => {
      const path = document.querySelector('.edge[data-connection="b"] .reach');
      const middle = path.getPointAtLength(path.getTotalLength() / 2).matrixTransform(path.getScreenCTM());
      return [middle.x, middle.y];
    });
    await page.mouse.click(x, y);
    await becomes(() => page.evaluate(() => window.studio.store.selection), { kind: 'connection', id: 'b' }, 'what is selected');
    await page.keyboard.press('Delete');
    await until('disconnect', () => asked(mock, 'disconnect').slice(count).some((m) => m.args.id === 'b'));
    await page.mouse.click(x + 3, y + 60);
    await becomes(() => page.evaluate(() => window.studio.store.selection), null, 'a click beside all selects nothing');
  }],
  ['the world or the system alone fill the middle', async ({ page }) => {
    const width = (name) => page.locator(name).evaluate((element) => element.getBoundingClientRect().width);
    const middle = (await width('.world-panel')) + (await width('.system-panel'));
    for (const [key, other] of [['2', '.system-panel'], ['3', '.world-panel']]) {
      await page.keyboard.press('Escape');
      await page.locator('.world canvas').focus().catch(() => {});
      await page.keyboard.press(key);
      await until(`${other} is as wide as both`, async () => (await width(other)) > middle - 12);
      await page.keyboard.press(key);
    }
  }],
  ['a rate that is no number empties nothing', async ({ page, mock }) => {
    const system = demo_system();
    system.revision = 5;
    system.components[0].contexts[0].rate = null; // as JSON has inf and NaN
    mock.say(system);
    await until('it says that there is none', async () => (await page.locator(`[data-path="${laser}"] .rate`).textContent()).includes('–'));
    same(await page.locator('.diagram .box').count(), 3, 'boxes');
    await choose(page, 'component', laser);
    await until('the inspector', async () => (await page.locator('.inspector h2').textContent()) === 'RTCLaser0');
    mock.say({ op: 'states', revision: 5, states: {}, rates: { [laser]: [null, true] } });
    mock.say(demo_system());
    await until('the rate', async () => !(await page.locator(`[data-path="${laser}"] .rate`).textContent()).includes('–'));
  }],
  ['buttons for all components have different names', async ({ page }) => {
    const names = await page.locator('#activate-all, #deactivate-all').evaluateAll((all) => all.map((b) => b.ariaLabel ?? b.textContent));
    same(new Set(names).size, 2, names.join());
  }],
  ['angles are typed in degrees', async ({ page, mock }) => {
    await choose(page, 'model', 'pioneer2dx');
    await page.locator('.inspector button', { hasText: 'Put' }).click();
    check((await page.locator('dialog label').first().textContent()).includes('°'), 'says so');
    await page.locator('#ask-text').fill('1 2 90');
    await page.keyboard.press('Enter');
    const put = await until('put', () => asked(mock, 'set_pose').find((m) => m.args.planar?.[0] === 1 && m.args.planar[1] === 2));
    check(Math.abs(put.args.planar[2] - Math.PI / 2) < 1e-9, JSON.stringify(put.args));
    await page.locator('.inspector button', { hasText: 'Set moving' }).click();
    await page.locator('#ask-text').fill('0 0 0 0 0 180');
    await page.keyboard.press('Enter');
    const moved = await until('moving', () => asked(mock, 'set_velocity').at(-1));
    check(Math.abs(moved.args.angular[2] - Math.PI) < 1e-9, JSON.stringify(moved.args));
    const before = asked(mock, 'spawn').length;
    await page.keyboard.press('Insert');
    await page.locator('#spawn-model').fill('box');
    await page.locator('#spawn-pose').fill('0 0 90');
    await page.locator('dialog button.main').click();
    const spawned = await until('spawned', () => asked(mock, 'spawn')[before]);
    await until('answered', () => page.evaluate(() => window.studio.wire.open.size === 0 && window.studio.store.acts.at(-1).text.startsWith('Spawn')));
    check(Math.abs(spawned.args.pose[6] - Math.SQRT1_2) < 1e-9, JSON.stringify(spawned.args));
  }],
  ['angles of signals are shown in degrees, in the inspector and in plots', async ({ page, mock }) => {
    const was = mock.answer;
    mock.answer = (message) => {
      if (message.name === 'watch' && message.args.members) setTimeout(() => mock.say({ op: 'values', watch: message.args.watch, t: [1], v: [[Math.PI / 2]] }, false), 20);
      else if (message.name === 'watch') setTimeout(() => mock.say({ op: 'values', watch: message.args.watch, t: [1], value: { data: { position: { x: 1.5 }, heading: Math.PI / 2, va: -Math.PI } } }, false), 20);
      return was(message);
    };
    await choose(page, 'signal', '/demo/RTCLaser0/range');
    await until('values', async () => (await page.locator('.inspector dl.values dd').allTextContents()).join(' ') === '1.5 90° -180°/s');
    await page.locator('.inspector button[aria-label="Plot data.heading"]').click();
    await until('a line', async () => (await page.locator('.plot .legend').textContent()).includes('data.heading [°]'));
    await until('its value', () => page.evaluate(() => window.studio.bottom.plots.plots[0].lines[0].values.at(-1) === 90));
    await page.locator('.plot .legend button').first().click();
    mock.answer = was;
  }],
  ['a model is deleted by the button or the key, and undo restores it before it undoes what came before', async ({ page, mock }) => {
    await page.evaluate(() => window.studio.act('Earlier', 'set_pose', {}, () => ({ text: 'Undo what was earlier', name: 'set_pose', args: { model: 'earlier' } })));
    for (const way of ['button', 'key']) {
      const count = asked(mock, 'delete_model').length;
      await choose(page, 'model', 'pioneer2dx');
      if (way === 'button') await page.locator('.inspector .danger', { hasText: 'Delete' }).click();
      else await page.keyboard.press('Delete');
      await until('deleted', () => asked(mock, 'delete_model').length === count + 1);
      await page.keyboard.press('Control+z');
      await until('restored', () => asked(mock, 'restore_model').at(count)?.args.model === 'pioneer2dx');
    }
    await page.keyboard.press('Control+z');
    await until('what came before', () => asked(mock, 'set_pose').at(-1).args.model === 'earlier');
  }],
  ['a wire offers by its context menu what can be done with it', async ({ page, mock }) => {
    const count = asked(mock, 'disconnect').length;
    const wire = await page.locator('.edge[data-connection="a"] .line').boundingBox();
    const menu = page.locator('.menu[role=menu]');
    await page.mouse.click(wire.x + wire.width / 2, wire.y + wire.height / 2, { button: 'right' });
    await menu.waitFor();
    same(await page.evaluate(() => window.studio.store.selection), { kind: 'connection', id: 'a' }, 'it is selected');
    same(await menu.locator('button').allTextContents(), ['DisconnectDelete', 'Show the values of range', 'Plot range', 'Select RTCLaser0:range', 'Select LaserObstacleAvoid0:range'], 'entries');
    await page.keyboard.press('Escape');
    await menu.waitFor({ state: 'detached' });
    await page.keyboard.press('Shift+F10');
    await menu.waitFor();
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Enter');
    await until('cut', () => asked(mock, 'disconnect').length === count + 1);
    await menu.waitFor({ state: 'detached' });
  }],
  ['ports, components and models have context menus, and a press elsewhere closes them', async ({ page, mock }) => {
    const menu = page.locator('.menu[role=menu]');
    await page.locator(`[data-port="${avoid}:range"] > path`).click({ button: 'right' });
    await menu.locator('button', { hasText: 'Write …' }).waitFor();
    await page.locator(`[data-path="${laser}"] .name`).click({ button: 'right', force: true, position: { x: 3, y: 3 } });
    const count = asked(mock, 'deactivate').length;
    await page.locator('.menu[aria-label="Component RTCLaser0"] button', { hasText: 'Deactivate' }).click();
    await until('deactivated', () => asked(mock, 'deactivate').at(count)?.args.path === laser);
    await page.evaluate(() => { window.studio.world.follow('pioneer2dx'); window.studio.world.draw(); });
    const box = await page.locator('.world canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2, { button: 'right' });
    await page.locator('.menu[aria-label="Model pioneer2dx"]').waitFor();
    await page.mouse.click(box.x + 5, box.y + 5);
    await menu.waitFor({ state: 'detached' });
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down({ button: 'right' });
    await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2, { steps: 3 });
    await page.mouse.up({ button: 'right' });
    same(await menu.count(), 0, 'a drag with the right button moves the eye');
    await page.evaluate(() => window.studio.world.whole());
  }],
  ['settings of a component fit into a narrow inspector', async ({ page, mock }) => {
    const was = mock.answer;
    mock.answer = (message) => (message.name === 'component' && message.args.path === avoid ? { result: { ...detail(avoid), sets: [{ id: 'default', active: true, values: [
      { name: 'a_parameter_with_a_name_that_is_long', value: '1', type: 'double', widget: 'slider.0.1', constraint: '0<=x<=180' }, { name: 'mode', value: 'the_first_of_the_choices', type: 'string', widget: 'radio', constraint: '(the_first_of_the_choices_there_are_here,another_choice_with_a_long_name_that_does_not_end)' },
      { name: 'order', value: 'a', type: 'string', widget: 'ordered_list', constraint: '(a_rather_long_word_of_an_ordered_list_that_does_not_end_soon,b)' }, { name: 'text', value: 'x'.repeat(90), type: 'string', widget: 'text' }, { name: 'spin', value: '3', type: 'int', widget: 'spin', constraint: '0<=x<=9' }] }] } } : was(message));
    await page.evaluate(() => { window.studio.dock.resize('inspector', 220); window.studio.store.details.clear(); });
    await choose(page, 'component', avoid);
    await until('its settings', async () => (await page.locator('.inspector').textContent()).includes('a_parameter_with'));
    const wide = () => page.evaluate(() => { const box = document.querySelector('.inspector').getBoundingClientRect(); return [...document.querySelectorAll('.inspector *')].filter((e) => { const { width, right } = e.getBoundingClientRect(); return width > 0 && right > box.right + 1; }).map((e) => `${e.tagName} ${e.className} ${e.id}`); });
    await becomes(wide, [], 'too wide');
    await page.evaluate(() => { window.studio.dock.resize('inspector', 300); });
    mock.answer = was;
  }],
  ['the bars of a telephone have one row each', async ({ browser, url }) => {
    const page = await open(browser, url, { width: 390, height: 844 });
    await has_world(page);
    for (const panel of ['world', 'system']) {
      await page.locator(`.panel-tabs [data-panel=${panel}]`).click();
      const rows = () => page.locator(`.${panel}-panel > .bar`).evaluate((bar) => new Set([...bar.children].map((e) => e.getBoundingClientRect()).filter((r) => r.width > 0).map((r) => Math.round((r.top + r.bottom) / 16))).size);
      await becomes(rows, 1, `rows of the bar of ${panel}`);
    }
    await becomes(() => page.evaluate(() => [...document.querySelectorAll('.top > *')].filter((e) => e.getBoundingClientRect().width > 0 && e.getBoundingClientRect().bottom > 44).length), 0, 'rows of the top');
    await page.context().close();
  }],
  ['the past of the time line stays when a model comes or goes, and not when another world comes', async ({ page, mock, world }) => {
    const index = await page.evaluate(() => window.studio.world.world.links.findIndex((l) => l.name === 'pioneer2dx::chassis'));
    const x = () => page.evaluate((i) => window.studio.world.world.links[i].position.x, index);
    const begins = () => page.evaluate(() => window.studio.bottom.history.first);
    const run_to = async (seconds, places, version) => {
      mock.say(poses(version, [[index, places, 0, 0.1]]), false);
      mock.say(time({ sim_time: seconds }), false);
      await until(`${seconds} s`, () => page.evaluate((t) => window.studio.store.time?.sim_time === t, seconds));
    };
    const changes = async (event) => {
      await page.evaluate(() => { window.was = window.studio.world.world; });
      mock.say(event);
      await page.waitForFunction(() => window.studio.world.world !== window.was);
    };
    await run_to(100, 1, world.version);
    await run_to(101, 2, world.version);
    mock.version = 2;
    await changes({ ...world, version: 2 });
    await run_to(102, 3, 2);
    check((await begins()) <= 100.001, `it begins at ${await begins()} s`);
    await page.evaluate(() => window.studio.bottom.history.show(100.05));
    check(Math.abs((await x()) - 1) < 1e-5, `where it was: ${await x()}`);
    await page.evaluate(() => window.studio.bottom.history.show(null));
    check(Math.abs((await x()) - 3) < 1e-5, `where it is: ${await x()}`);
    await changes({ ...world, version: 2, birth: 'of another simulator' });
    await run_to(103, 4, 2);
    check((await begins()) >= 102.9, `another world begins at ${await begins()} s`);
    mock.version = undefined;
    await changes(world);
    mock.say(time());
  }],
  ['scans and trails of a live run are those of the moment that the time line shows', async ({ page, mock, world }) => {
    const index = await page.evaluate(() => window.studio.world.world.links.findIndex((l) => l.name === 'pioneer2dx::chassis'));
    const fans = () => asked(mock, 'watch').filter((m) => m.args.topic.includes('laser') && m.args.hz === 15), before = fans().length;
    await page.evaluate(() => { window.studio.world.ranges.clear(); window.studio.world.apply_settings(); });
    const fan = (await until('the watch of a fan', () => fans()[before])).args.watch; // of this page, whatever others have asked for
    const seen = () => page.evaluate(() => {
      const { world } = window.studio, [fan] = world.ranges.fans.values(), [trail] = world.trails.trails.values(), points = fan.parts[0].geometry.getAttribute('position');
      return { visible: fan.parts[0].visible, first: points ? Math.hypot(points.getX(1), points.getY(1)) : 0, trail: trail?.line.geometry.drawRange.count ?? 0 };
    });
    const at = (seconds) => { const frame = poses(world.version, [[index, seconds - 200, 4, 0.1]]); frame.writeBigUInt64LE(BigInt(seconds * 1e9), 8); return frame; };
    for (let seconds = 201; seconds <= 206; ++seconds) {
      mock.say(at(seconds), false);
      mock.say({ op: 'values', watch: fan, t: [seconds], value: { ranges: Array.from({ length: 60 }, () => (seconds - 200) / 2) } }, false);
      mock.say(time({ sim_time: seconds }), false);
      await until(`${seconds} s`, () => page.evaluate((t) => window.studio.store.time?.sim_time === t, seconds));
      await drawn(page); // what is drawn has followed, also the first jump
    }
    const now = await until('the newest scan and a trail', async () => { const is = await seen(); return Math.abs(is.first - 3) < 1e-5 && is.trail >= 6 && is; });
    await page.evaluate(() => window.studio.bottom.look(202.5));
    const then = await seen();
    check(then.visible && Math.abs(then.first - 1) < 1e-5, `the scan of then: ${JSON.stringify(then)}`);
    same(now.trail - then.trail, 4, 'points that were still to come');
    mock.say({ op: 'values', watch: fan, t: [206.2], value: { ranges: Array.from({ length: 60 }, () => 4) } }, false);
    mock.say(at(207), false);
    await until('it was told', () => page.evaluate(() => window.studio.world.told_time === 207));
    check(Math.abs((await seen()).first - 1) < 1e-5 && (await seen()).trail === then.trail, 'what comes meanwhile changes nothing that is shown');
    await page.evaluate(() => window.studio.bottom.look(null));
    same((await seen()).trail, now.trail + 1, 'and is there afterwards');
    check(Math.abs((await seen()).first - 4) < 1e-5, 'the scan of now');
    mock.say(time());
  }],
  ['trails end with the world that they were made in', async ({ page, mock, world }) => {
    const index = await page.evaluate(() => window.studio.world.world.links.findIndex((l) => l.name === 'pioneer2dx::chassis'));
    for (const x of [3, 3.2, 3.4]) mock.say(poses(world.version, [[index, x, 1, 0.1]]));
    const points = () => page.evaluate(() => [...window.studio.world.trails.trails.values()].reduce((sum, trail) => sum + trail.count, 0));
    await until('a trail', async () => (await points()) > 1);
    await page.evaluate(() => { window.was = window.studio.world.world; });
    mock.say({ ...world, birth: 'a new one' });
    await page.waitForFunction(() => window.studio.world.world !== window.was);
    check((await points()) <= 2, `${await points()} points`);
    mock.say(world);
    await page.waitForFunction(() => window.studio.world.world !== window.was);
  }],
  ['boxes are placed by hand and stay there', async ({ page, url, browser }) => {
    const box = await page.locator(`[data-path="${laser}"] .band`).boundingBox();
    await page.mouse.move(box.x + 30, box.y + 10);
    await page.mouse.down();
    await page.mouse.move(box.x + 30, box.y + 110, { steps: 4 });
    await page.mouse.up();
    const place = await until('remembered', () => page.evaluate((path) => window.studio.settings.positions[path], laser));
    await until('stored', () => page.evaluate(() => (localStorage.getItem('rtm-studio') ?? '').includes('positions":{"/')));
    const other = await page.context().newPage();
    await other.goto(url);
    await is_ready(other);
    same(await until('there', () => other.evaluate((path) => window.studio.settings.positions[path], laser)), place, 'place');
    await other.close();
    await page.locator('button[aria-label="Arrange automatically"]').click();
    void browser;
  }],
  ['a signal is dragged into the plots', async ({ page, mock }) => {
    await page.evaluate(() => window.studio.select({ kind: 'signal', id: '/demo/RTCLaser0/range' }));
    // The value is said again until it is shown: the newest watch may still be one of an earlier selection.
    await until('the scan', () => {
      const watch = asked(mock, 'watch').findLast((m) => m.args.topic === '/demo/RTCLaser0/range' && !m.args.members)?.args.watch;
      if (watch) mock.say({ op: 'values', watch, t: [12], value: { tm: { sec: 1, nsec: 2 }, config: { minAngle: -2 }, ranges: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10] } });
      return page.locator('.inspector canvas.polar').isVisible();
    });
    await page.locator('.inspector button[aria-label="Plot config.minAngle"]').click();
    await page.locator('.plot .legend').waitFor();
    const plotted = await until('plot watch', () => asked(mock, 'watch').find((m) => m.args.members?.[0] === 'config.minAngle')?.args.watch);
    mock.say({ op: 'values', watch: plotted, t: [12.0, 12.1, 12.2], v: [[1], [2], [3]] });
    await page.locator('.plot canvas').waitFor();
    await page.locator('.plot .legend button').first().click();
    await until('gone', async () => (await page.locator('.plot').count()) === 0);
  }],
  ['plots are zoomed by a drag and the wheel, show values at the cursor, and are saved as CSV', async ({ page, mock }) => {
    const was = mock.answer;
    mock.answer = (message) => {
      if (message.name === 'watch' && message.args.members?.[0] === 'data.vx') setTimeout(() => mock.say({ op: 'values', watch: message.args.watch, t: Array.from({ length: 60 }, (_, i) => i / 2), v: Array.from({ length: 60 }, (_, i) => [i]) }, false), 20);
      return was(message);
    };
    mock.say(time({ sim_time: 30 }));
    await page.evaluate(() => window.studio.bottom.plots.add('/demo/RTCLaser0/range', 'data.vx'));
    await until('its samples', () => page.evaluate(() => window.studio.bottom.plots.plots[0].lines[0].values.length === 60));
    await page.locator('.u-over').waitFor();
    const shown = () => page.evaluate(() => { const { min, max } = window.studio.bottom.plots.plots[0].plot.scales.x; return [min, max]; });
    await until('all of it', async () => Math.abs((await shown())[1] - 30) < 0.1);
    const over = await until('the plot', () => page.locator('.u-over').boundingBox());
    let moves = 0; // a plot that is made anew meanwhile hears of the next one
    await until('the value at the cursor', async () => {
      await page.mouse.move(over.x + over.width / 2, over.y + 20 + (moves++ % 2));
      return /data\.vx = (29|30|31)/.test(await page.locator('.plot .legend').textContent());
    });
    await page.mouse.move(over.x + over.width * 0.25, over.y + 20);
    await page.mouse.down();
    await page.mouse.move(over.x + over.width * 0.5, over.y + 25, { steps: 4 });
    await page.mouse.up();
    await until('zoomed', async () => Math.abs((await shown())[0] - 7.5) < 0.5 && Math.abs((await shown())[1] - 15) < 0.5);
    same(await page.locator('#live').getAttribute('aria-pressed'), 'true', 'a drag chooses no moment');
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('.plot .csv').click()]);
    const rows = readFileSync(await download.path(), 'utf8').trim().split('\n');
    same(rows[0], 'time [s],/demo/RTCLaser0/range data.vx', 'head');
    check(rows.length > 12 && rows.length < 20 && rows.includes('10,20'), rows.join(' '));
    await page.mouse.move(over.x + over.width * 0.5, over.y + 20);
    await page.mouse.wheel(0, 200);
    await until('further away', async () => { const [min, max] = await shown(); return max - min > 9; });
    await page.locator('.zoom-out').click();
    await until('all again', async () => Math.abs((await shown())[1] - 30) < 0.1);
    await page.locator('.plot .legend button').first().click();
    mock.answer = was;
    mock.say(time());
  }],
  ['time is paused when a value becomes true of a comparison, once each time', async ({ page, mock }) => {
    const was = mock.answer, pauses = () => asked(mock, 'pause').length;
    mock.say(time({ paused: false }));
    await choose(page, 'signal', '/demo/RTCLaser0/range');
    await page.locator('#pause-when').click();
    await page.locator('#break-member').selectOption('data.vx');
    await page.locator('#break-compare').selectOption('>');
    await page.locator('#break-value').fill('0.5');
    await page.locator('dialog[open] button.main').click();
    const id = (await until('its watch', () => asked(mock, 'watch').findLast((m) => m.args.members?.[0] === 'data.vx'))).args.watch;
    const before = pauses();
    mock.say({ op: 'values', watch: id, t: [1, 2, 3, 4], v: [[0.1], [0.4], [0.6], [0.7]] }, false);
    await until('paused', () => pauses() === before + 1);
    await until('it shows that it holds', async () => (await page.locator('.breaks .met').count()) === 1);
    mock.say({ op: 'values', watch: id, t: [5, 6], v: [[0.1], [0.8]] }, false);
    await until('paused again', () => pauses() === before + 2);
    await until('why', async () => (await page.locator('.status .act').textContent()).includes('data.vx > 0.5'));
    await page.locator('.breaks button').click();
    await until('no watch', () => asked(mock, 'unwatch').some((m) => m.args.watch === id));
    await choose(page, 'component', laser);
    await page.locator('#pause-on-error').click();
    await until('pressed', async () => (await page.locator('#pause-on-error').getAttribute('aria-pressed')) === 'true');
    mock.say({ op: 'states', revision: 1, states: { [laser]: 'Error' }, rates: {} });
    await until('paused by the error', () => pauses() === before + 3);
    mock.say({ op: 'states', revision: 1, states: { [laser]: 'Active' }, rates: {} });
    await page.locator('#pause-on-error').click();
    await until('none', async () => (await page.locator('.breaks li').count()) === 0);
    mock.say(time());
    mock.answer = was;
  }],
  ['logs are filtered', async ({ page, mock }) => {
    await choose(page, 'model', 'pioneer2dx');
    mock.say({ op: 'logs', lines: [['WARN', 'the laser is slow'], ['INFO', 'all is well']].map(([level, text]) => ({ level, source: 'RTCLaser0', time: 3.25, text })) });
    await page.locator('#tab-logs').click();
    await until('both', async () => (await page.locator('.log > div').count()) === 2);
    await page.locator('input[aria-label="Filter logs"]').fill('slow');
    await until('one', async () => (await page.locator('.log > div').count()) === 1);
    await page.locator('input[aria-label="Filter logs"]').fill('');
    await page.locator('#tab-plots').click();
  }],
  ['time: run, step, reset, speed', async ({ page, mock }) => {
    const pauses = asked(mock, 'pause').length;
    await page.locator('.world canvas').focus();
    for (const [key, name] of [[' ', 'run'], ['.', 'step'], ['Shift+R', 'reset_world']]) {
      await page.keyboard.press(key === ' ' ? 'Space' : key);
      await until(name, () => asked(mock, name).length === 1);
    }
    mock.say(time({ paused: false }));
    await until('pause is offered', () => page.locator('#run[aria-label=Pause]').count());
    await page.locator('#run').click();
    await until('pause', () => asked(mock, 'pause').length === pauses + 1);
    await page.locator('#speed').fill('4');
    await page.keyboard.press('Enter');
    await until('speed', () => asked(mock, 'speed').at(-1)?.args.rtf === 4);
    mock.say(time({ participants: [{ name: 'RTCLaser0', pid: 1, phase: 0, rate: 100, ticks: 5, missed: 0, mean_us: 3, max_us: 9, active: true, late: true }] }));
    await until('who is waited for', async () => (await page.locator('.waits').textContent()).includes('RTCLaser0'));
    mock.say(time());
  }],
  ['panels are hidden by keys and sized by keys', async ({ page }) => {
    await page.locator('.world canvas').focus();
    await page.keyboard.press('1');
    await page.locator('.tree-panel').waitFor({ state: 'hidden' });
    await page.keyboard.press('1');
    await page.locator('.tree-panel').waitFor();
    const before = (await page.locator('.tree-panel').boundingBox()).width;
    await page.locator('.of-tree').focus();
    await page.keyboard.press('ArrowRight');
    await until('wider', async () => (await page.locator('.tree-panel').boundingBox()).width > before);
  }],
  ['a panel is dragged by its grip beside another, as a tab, and to an edge', async ({ page }) => {
    const box = (panel) => page.locator(`.${panel}-panel`).boundingBox();
    const drag = async (panel, x, y) => {
      const grip = await page.locator(`.${panel}-panel .grip`).boundingBox();
      await page.mouse.move(grip.x + 6, grip.y + 6);
      await page.mouse.down();
      await page.mouse.move(x, y, { steps: 4 });
      await page.locator('.drop').waitFor();
      await page.mouse.up();
    };
    const tree = await box('tree');
    await drag('inspector', tree.x + tree.width / 2, tree.y + tree.height - 20);
    await until('the inspector is below the tree', async () => { const [above, below] = [await box('tree'), await box('inspector')]; return below.y > above.y + above.height - 10 && Math.abs(below.x - above.x) < 2; });
    const world = await box('world');
    await drag('system', world.x + world.width / 2, world.y + world.height / 2);
    await until('the system is in front of the world', async () => (await page.locator('.system-panel').isVisible()) && !(await page.locator('.world-panel').isVisible()));
    await page.locator('.leaf-tabs [data-panel=world]').click();
    await page.locator('.world-panel').waitFor();
    await page.keyboard.press('3');
    await page.locator('.system-panel').waitFor();
    await drag('bottom', 3, 300);
    await until('time at the left edge', async () => { const { x, height } = await box('bottom'); return x < 2 && height > 600; });
    await until('kept', () => page.evaluate(() => JSON.parse(localStorage.getItem('rtm-studio')).layout.root.parts[0].shown === 'bottom'));
  }],
  ['a layout is saved under a name, and comes back after another one and after a reload', async ({ page }) => {
    const entry = async (text) => { await page.locator('#layouts').click(); await page.locator('.menu button', { hasText: text }).click(); };
    await entry('Save this layout');
    await page.locator('#ask-text').fill('tuning');
    await page.locator('dialog[open] button.main').click();
    await until('kept', () => page.evaluate(() => 'tuning' in JSON.parse(localStorage.getItem('rtm-studio')).layouts));
    await entry('Usual layout');
    await until('the usual one', async () => (await page.locator('.bottom-panel').boundingBox()).x < 2 && (await page.locator('.tree-panel').boundingBox()).y < 60 && (await page.locator('.bottom-panel').boundingBox()).y > 300);
    await entry(/^tuning$/);
    await page.locator('#layouts').click();
    // A change is kept although the page is left in the same moment.
    await Promise.all([page.waitForEvent('load'), page.evaluate(() => {
      [...document.querySelectorAll('.menu button')].find((button) => button.textContent.includes('Usual layout')).click();
      location.hash = '';
      location.reload();
    })]);
    await is_ready(page);
    await has_world(page);
    await entry(/^tuning$/);
    await until('the saved one', async () => (await page.locator('.bottom-panel').boundingBox()).height > 600);
    await entry('Delete tuning');
    await entry('Usual layout');
    await page.locator('.inspector-panel .grip').focus();
    await page.keyboard.press('Enter');
    await page.locator('.menu button', { hasText: 'As a tab of Tree' }).click();
    await until('by the keyboard, too', async () => (await page.locator('.inspector-panel').isVisible()) && !(await page.locator('.tree-panel').isVisible()));
    await entry('Usual layout');
  }],
  ['a link holds the view', async ({ page, browser }) => {
    await page.evaluate(() => { window.studio.world.top(); window.studio.select({ kind: 'model', id: 'pioneer2dx' }); });
    await until('link', () => page.evaluate(() => { const m = /v=([\w-]+)/.exec(location.hash); return m && atob(m[1].replaceAll('-', '+').replaceAll('_', '/')).includes('"mode":"top"'); }));
    await page.evaluate(() => Object.assign(navigator.clipboard, { writeText: async (text) => { window.copied = text; } }));
    await page.locator('#copy-link').click();
    const link = await until('the copied link', () => page.evaluate(() => window.copied));
    const without = await open(browser, link.replace(/&token=.*/, ''));
    await until('it asks for the token', async () => (await without.locator('.link-state').textContent()).startsWith('no token'));
    await without.context().close();
    const other = await open(browser, link);
    await has_world(other);
    await becomes(() => other.evaluate(() => [window.studio.world.eye.mode, window.studio.store.selection?.id]), ['top', 'pioneer2dx'], 'view');
    await other.context().close();
    await page.evaluate(() => window.studio.world.whole());
  }],
  ['everything has a name for those who do not see it', async ({ page }) => {
    for (const theme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme: theme });
      for (const [kind, id] of [['model', 'pioneer2dx'], ['component', laser], ['connection', 'a']]) {
        await choose(page, kind, id);
        await drawn(page);
        if (!(await page.evaluate(() => Boolean(window.axe)))) await page.addScriptTag({ path: axe });
        const result = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
        const bad = result.violations.filter((v) => v.impact === 'serious' || v.impact === 'critical');
        check(bad.length === 0, `${theme} ${kind}: ${bad.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 140) + ' ' + (n.any[0]?.message ?? '')).join(' | ')}`).join('; ')}`);
      }
    }
    await page.emulateMedia({ colorScheme: 'light' });
  }],
  ['narrow and wide screens show everything', async ({ browser, url }) => {
    const page = await open(browser, url, { width: 360, height: 700 });
    await has_world(page);
    await choose(page, 'component', avoid); // the system is not seen yet
    for (const panel of ['tree', 'world', 'system', 'inspector', 'bottom']) {
      await page.locator(`.panel-tabs [data-panel=${panel}]`).click();
      await page.locator(`.${panel}-panel`).waitFor();
      await until(`${panel} is as wide as the screen`, () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      await becomes(() => page.evaluate(() => [...document.querySelectorAll('button, input, select')].filter((e) => { const { width, left, right } = e.getBoundingClientRect(); return width > 0 && (left < -1 || right > innerWidth + 1); }).map((e) => e.id || e.ariaLabel)), [], `out of reach in ${panel}`);
    }
    await page.locator('.panel-tabs [data-panel=system]').click();
    const left = () => page.evaluate(() => Math.min(...[...document.querySelectorAll('.diagram .box')].map((b) => b.getBoundingClientRect().left)));
    await until('all boxes are seen', async () => (await left()) >= 0);
    await page.setViewportSize({ width: 3840, height: 2160 });
    for (const panel of ['tree', 'world', 'system', 'inspector', 'bottom']) await until(`${panel} on a wall`, () => page.locator(`.${panel}-panel`).isVisible());
    await page.context().close();
  }],
  ['read-only: it may look, not act', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    mock.answer = answer(mock);
    for (const event of [hello({ read_only: true }), demo_system(), await world_of(glb), time()]) mock.say(event);
    const page = await open(browser, await mock.start());
    await has_world(page);
    await until('no run', () => page.locator('#run').isDisabled());
    await until('no activation of all', () => page.locator('#activate-all').isDisabled());
    await choose(page, 'component', laser);
    await until('the inspector', async () => (await page.locator('.inspector h2').textContent()) === 'RTCLaser0');
    same(await page.locator('#act-deactivate').count(), 0, 'buttons');
    await until('it says so', async () => (await page.locator('footer').textContent()).includes('read-only'));
    await page.keyboard.press('Space');
    same(asked(mock, 'run').length, 0, 'nothing was asked');
    await page.context().close();
    mock.stop();
  }],
  ['empty and broken states say what to do', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    mock.answer = answer(mock);
    for (const event of [hello({ name_server: 'localhost:2999', start: { simulator: 'bin/sim-server worlds/x.sdf', components: 'bin/rtcd --with-naming Laser' } }), { op: 'system', revision: 1, problem: 'no naming service at localhost:2999', components: [], connections: [], managers: [] }, { op: 'world', present: false, problem: 'no simulator of number 0 runs', models: [], ifaces: [], version: 0, links: 0 }]) mock.say(event);
    const url = await mock.start();
    const page = await open(browser, url);
    await until('world says', async () => (await page.locator('.world .card').textContent()).includes('bin/sim-server worlds/x.sdf'));
    await until('the system says where it looks and what to start', async () => { const card = await page.locator('.diagram .card').textContent(); return card.includes('localhost:2999') && card.includes('bin/rtcd --with-naming Laser'); });
    mock.say(demo_system());
    await until('system comes', async () => (await page.locator('.diagram .box').count()) === 3);
    mock.say(await world_of(glb));
    await has_world(page);
    mock.stop();
    await until('gone', async () => (await page.locator('.world .card').textContent()).includes('reconnects'));
    await page.context().close();
  }],
  ['it comes back after the server was gone', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    mock.answer = answer(mock);
    for (const event of [hello(), demo_system(), await world_of(glb), time()]) mock.say(event);
    const url = await mock.start();
    const page = await open(browser, url);
    await has_world(page);
    mock.stop();
    await until('lost', () => page.evaluate(() => window.studio.wire.status === 'lost'));
    const again = new Mock({ page: built, glb });
    again.answer = answer(again);
    again.first = mock.first;
    await again.start(Number(new URL(url).port));
    await until('back', () => page.evaluate(() => window.studio.wire.status === 'open'));
    await until('its scans are asked for again', () => asked(again, 'watch').length > 0);
    await until('no notice', async () => (await page.locator('.world .card').count()) === 0);
    await page.context().close();
    again.stop();
  }],
  ['equal robots of a fleet are folded into one, and what concerns one of them is seen', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    for (const event of [hello(), fleet(100), time()]) mock.say(event);
    const page = await open(browser, await mock.start());
    await until('all', async () => (await page.locator('.diagram .box').count()) === 200);
    await page.getByRole('button', { name: 'Fold equal robots' }).click();
    await until('folded', async () => (await page.locator('.diagram .box').count()) === 4);
    await becomes(() => page.locator('.diagram .box .name').allTextContents(), ['Dispatcher', 'Laser_r0', 'Avoid_r0', 'Avoid_r2'], 'boxes');
    await becomes(() => page.locator('.diagram .box .count').allTextContents(), ['× 99', '× 99'], 'numbers');
    await becomes(() => page.locator('.diagram .edge').count(), 3, 'lines');
    mock.say({ op: 'states', revision: 2, states: { [`${host}/Laser_r77.rtc`]: 'Error' }, rates: {} });
    await until('error', async () => (await page.locator(`.box.state-error[data-path="${host}/Laser_r0.rtc"]`).count()) === 1);
    await until('its title counts them', async () => (await page.locator(`[data-path="${host}/Laser_r0.rtc"] > title`).textContent()).includes('98 active, 1 in error'));
    await page.getByRole('button', { name: 'Fold equal robots' }).click();
    await until('all again', async () => (await page.locator('.diagram .box').count()) === 200);
    await page.context().close();
    mock.stop();
  }],
  ['a thousand components can be panned', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    for (const event of [hello(), many_components(1000), time()]) mock.say(event);
    const page = await open(browser, await mock.start());
    await until('boxes', async () => (await page.locator('.diagram .box').count()) === 1000);
    const box = await page.locator('.diagram svg').boundingBox();
    const before = await page.evaluate(() => window.studio.diagram.frames);
    await page.mouse.move(box.x + 8, box.y + 8);
    await page.mouse.down();
    for (let i = 0; i < 10; ++i) await page.mouse.move(box.x + 8 + 9 * i, box.y + 8 + 3 * i);
    await page.mouse.up();
    await until('it moved', () => page.evaluate((frames) => window.studio.diagram.frames > frames, before));
    await page.locator('.tree input').fill('Part777');
    await until('found', async () => (await page.locator('.tree li[data-key$="Part777.rtc"]').count()) === 1);
    await page.context().close();
    mock.stop();
  }],
  ['names that mean mischief are only text', async ({ browser }) => {
    const mock = new Mock({ page: built, glb });
    const bad = '<img src=x onerror="window.hurt=1">"\'&';
    for (const event of [hello(), { op: 'system', revision: 1, problem: '', managers: [], connections: [], components: [component(bad, bad, 'Active', [[bad, 'in', bad]])] }, { op: 'signals', signals: [{ topic: bad, kind: 'port', type: bad }] }, { op: 'logs', lines: [{ time: 1, level: bad, source: bad, text: bad }] }]) mock.say(event);
    const page = await open(browser, await mock.start());
    await until('box', async () => (await page.locator('.diagram .box').count()) === 1);
    await choose(page, 'component', `${host}/${bad}.rtc`);
    await page.locator('#tab-logs').click();
    await until('its log', async () => (await page.locator('.log > div').count()) === 1);
    await page.evaluate(() => new Promise((fails) => { const image = new Image(); image.onerror = fails; image.src = 'y'; })); // after one of the page would have
    same(await page.evaluate(() => window.hurt), undefined, 'mischief');
    await page.context().close();
    mock.stop();
  }],
];

run(flows, set_up, async (shared) => shared?.mock.stop());
