// What is late loses nothing: a server that answers slowly or in another order, frames that have not come yet, parts of the page that are drawn
// anew under a finger. The page alone, in front of a stand-in that holds its answers back: late_flows.mjs BIN_DIR SOURCE_DIR.
import { join } from 'node:path';
import { demo_system, hello, Mock, poses, time, token, world_of } from './mock.mjs';
import { becomes, check, drawn, has_world, is_ready, open, run, same, until } from './rig.mjs';

const [bin, source] = process.argv.slice(2);
const built = process.env.STUDIO_PAGE ?? join(bin, '../share/rtm-sim/studio');
const glb = join(source, 'tests/studio/course.glb');
const host = '/localhost:2809/demo.host_cxt';
const laser = `${host}/RTCLaser0.rtc`, avoid = `${host}/LaserObstacleAvoid0.rtc`;

const detail = (path, turn) => ({
  ...demo_system().components.find((c) => c.path === path), properties: {},
  sets: [{ id: 'default', active: true, values: [{ name: 'max_turn', value: String(turn), type: 'double', widget: 'text' }] }],
});

function answer({ name, args }) {
  if (name === 'component') return { result: detail(args.path, 60) };
  if (name === 'connection_options') return { result: { problem: '', properties: [{ key: 'dataport.subscription_type', values: ['flush', args.ports[1].includes('Position') ? 'periodic' : 'new'], default: 'flush' }] } };
  if (name === 'connect') return { result: { id: 'made' }, command: `rtse con ${args.ports.join(' ')} ${args.name}` };
  return {};
}

const asked = (mock, name) => mock.asked.filter((m) => m.name === name && !m.dry);
const held = (mock, name, count = 1) => until(`${count} ${name} that wait`, () => mock.held.filter((h) => h.message.name === name).length >= count);
const choose = (page, kind, id) => page.evaluate(([k, i]) => window.studio.select({ kind: k, id: i }), [kind, id]);

async function with_page({ browser, events = [] }, work) {
  const mock = new Mock({ page: built, glb });
  mock.answer = answer;
  for (const event of events) mock.say(event);
  const page = await open(browser, await mock.start());
  try {
    await work({ mock, page });
    same(page.problems, [], 'problems of the page');
  } finally {
    await page.context().close();
    mock.stop();
  }
}

async function set_up(browser) {
  return { browser, events: [hello(), demo_system(), await world_of(glb), time()], world: await world_of(glb) };
}

const flow = (name, work, change = (events) => events) => [name, (shared) => with_page({ ...shared, events: change(shared.events) }, ({ mock, page }) => work({ ...shared, mock, page }))];

const flows = [
  flow('what is asked before the server has greeted is answered', async ({ mock, page }) => {
    await until('open', () => page.evaluate(() => window.studio?.wire.status === 'open'));
    mock.holds = ({ name }) => name === 'models';
    const said = page.evaluate(() => window.studio.wire.request('models').then(() => 'answered', (error) => error.message));
    await held(mock, 'models');
    mock.say(hello());
    await is_ready(page);
    mock.release_all();
    same(await said, 'answered', 'the request');
  }, () => []),
  flow('an old word that the server is gone is not believed', async ({ mock, page }) => {
    await has_world(page);
    mock.holds_file = (method, path) => path === '/access';
    for (const socket of mock.sockets) socket.destroy();
    await held(mock, '/access');
    await until('it is back', () => page.evaluate(() => window.studio.wire.status === 'open'));
    mock.refuses = true;
    const answered = page.waitForResponse((reply) => reply.url().endsWith('/access'));
    mock.release_all();
    await answered;
    await drawn(page);
    same(await page.evaluate(() => window.studio.wire.status), 'open', 'status');
  }),
  flow('a token in the address is taken, also when the page writes its view there in the same moment', async ({ page }) => {
    await is_ready(page);
    const reloaded = page.waitForEvent('load');
    await page.evaluate((one) => {
      sessionStorage.clear();
      location.hash = `#token=${one}`;
      history.replaceState(null, '', '#');
    }, token);
    await reloaded;
    await is_ready(page);
  }),
  flow('a tab without a token takes that of another tab, also when the other answers late', async ({ page }) => {
    await is_ready(page);
    const tab = await page.context().newPage();
    await tab.addInitScript(() => {
      const later = window.setTimeout;
      window.setTimeout = (work, limit, ...more) => (limit === 500 ? work() : later(work, limit, ...more));
    });
    await tab.goto(page.url().replace(/#.*/, ''));
    await is_ready(tab);
    await tab.close();
  }),
  flow('an answer to an earlier question says nothing new of a component', async ({ mock, page }) => {
    await has_world(page);
    mock.holds = ({ name, args }) => name === 'component' && args.path === avoid;
    // The page asks again by itself every two seconds; each question has a higher answer than the one before.
    let turn = 1000;
    mock.answer = (message) => (message.name === 'component' && message.args.path === avoid ? { result: detail(avoid, turn++) } : answer(message));
    await choose(page, 'component', avoid);
    await held(mock, 'component');
    await choose(page, 'component', laser);
    await choose(page, 'component', avoid);
    await held(mock, 'component', 2);
    mock.release(1);
    const field = () => page.evaluate((path) => Number(window.studio.store.details.get(path)?.sets[0].values[0].value), avoid);
    const shown = await until('the second', async () => { const value = await field(); return value > 1000 && value; });
    mock.release_all();
    await page.evaluate(() => window.studio.wire.request('models'));
    check((await field()) >= shown, `max_turn is ${await field()} after ${shown}`);
  }),
  flow('what is typed stays while the rest is shown', async ({ mock, page }) => {
    await has_world(page);
    await choose(page, 'component', avoid);
    const field = page.locator('.inspector label:has-text("max_turn") + *');
    await field.fill('75');
    mock.say({ op: 'states', revision: 1, states: { [avoid]: 'Error' }, rates: {} });
    await drawn(page);
    same(await field.inputValue(), '75', 'what is typed'); // not the value before, also when all is drawn
    await page.keyboard.press('Enter');
    await until('set', () => asked(mock, 'set_configuration').some((m) => m.args.values.max_turn === '75'));
    mock.answer = (message) => (message.name === 'component' ? { result: detail(message.args.path, 75) } : answer(message));
    await until('the state is shown, too', async () => (await page.locator('.inspector .state').textContent()).includes('error'));
  }),
  flow('a click holds on what is drawn anew meanwhile', async ({ mock, page }) => {
    const late = time({ participants: [{ name: 'RTCLaser0', pid: 1, phase: 0, rate: 100, ticks: 5, missed: 0, mean_us: 3, max_us: 9, active: true, late: true }] });
    await has_world(page);
    // What was said before is there and drawn: where things are is where they stay.
    const settled = async () => {
      await page.evaluate(() => window.studio.wire.request('models'));
      await drawn(page);
    };
    const press = async (locator, meanwhile) => {
      await locator.waitFor();
      await settled();
      const box = await until('it is drawn', () => locator.boundingBox());
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      meanwhile();
      await settled();
      await page.mouse.up();
    };
    const others = (state) => () => mock.say({ ...demo_system(), revision: 2, components: demo_system().components.map((c) => ({ ...c, state })) });
    await press(page.locator(`.tree li[data-key="component:${laser}"] .label`), others('Inactive'));
    await until('chosen in the tree', () => page.evaluate((p) => window.studio.store.selection?.id === p && window.studio.store.details.has(p), laser));
    await press(page.locator('#act-exit'), others('Error'));
    await until('exit', () => asked(mock, 'exit').length === 1);
    await until('and then it is drawn', async () => (await page.locator('.inspector .state').textContent()).includes('error'));
    mock.say(late);
    await page.locator('#tab-step').click();
    await press(page.locator('.parts button'), () => mock.say({ ...late, steps: 99, sim_time: 13 }));
    await until('drop', () => asked(mock, 'drop_participant').length === 1);
    mock.say({ op: 'logs', lines: [{ level: 'INFO', source: 'a', time: 3.25, text: 'one' }] });
    await page.evaluate(() => window.studio.select(null));
    await page.locator('#tab-logs').click();
    await press(page.locator('.log button').first(), () => mock.say({ op: 'logs', lines: [{ level: 'INFO', source: 'a', time: 4.25, text: 'two' }] }));
    await until('the moment of the first line', async () => (await page.locator('.clock').textContent()) === '3.250 s');
  }),
  flow('a box that is dragged goes where it is put, whatever comes meanwhile', async ({ mock, page }) => {
    await has_world(page);
    const box = page.locator(`[data-path="${laser}"] .band`);
    await box.waitFor();
    await drawn(page);
    const before = await box.boundingBox();
    await page.mouse.move(before.x + 30, before.y + 10);
    await page.mouse.down();
    await page.mouse.move(before.x + 30, before.y + 60, { steps: 3 });
    mock.say({ ...demo_system(), revision: 2, connections: [] });
    await drawn(page);
    await page.mouse.move(before.x + 30, before.y + 110, { steps: 3 });
    await page.mouse.up();
    await until('the system as it is now', async () => (await page.locator('.diagram .edge').count()) === 0);
    const after = await box.boundingBox();
    check(Math.abs(after.y - before.y - 100) < 2, `it went ${after.y - before.y} pixels`);
  }),
  flow('the connection dialog shows what the chosen pair can', async ({ mock, page }) => {
    await has_world(page);
    await choose(page, 'port', `${avoid}:velocity`);
    mock.say({ ...demo_system(), revision: 2, components: [...demo_system().components, { ...demo_system().components[2], path: `${host}/Other0.rtc`, instance: 'Other0' }] });
    await until('four', async () => (await page.locator('.diagram .box').count()) === 4);
    mock.holds = ({ name }) => name === 'connection_options';
    await page.keyboard.press('c');
    await held(mock, 'connection_options');
    await page.locator('#connect-to').selectOption(`${host}/Other0.rtc:velocity`);
    await held(mock, 'connection_options', 2);
    mock.release(1);
    await until('its properties', async () => (await page.locator('dialog select[data-key] option').allTextContents()).includes('new'));
    mock.release_all();
    await page.evaluate(() => window.studio.wire.request('models'));
    check((await page.locator('dialog select[data-key] option').allTextContents()).includes('new'), 'those of the pair that is chosen');
    await page.keyboard.press('Escape');
  }),
  flow('undo means the act that was just done, also before it is answered', async ({ mock, page }) => {
    await has_world(page);
    await page.evaluate(() => window.studio.act('Put a', 'set_pose', { model: 'a', planar: [0, 0, 0] }, () => ({ text: 'Put a back', name: 'set_pose', args: { model: 'first' } })));
    mock.holds = ({ name }) => name === 'connect';
    await page.evaluate(() => void window.studio.act('Connect', 'connect', { ports: ['a', 'b'], name: 'n' }, ({ id }) => ({ text: 'Disconnect', name: 'disconnect', args: { id } })));
    await held(mock, 'connect');
    await page.keyboard.press('Control+z');
    await page.evaluate(() => window.studio.wire.request('models'));
    mock.release_all();
    await until('disconnect', () => asked(mock, 'disconnect').some((m) => m.args.id === 'made'));
    same(asked(mock, 'set_pose').filter((m) => m.args.model === 'first').length, 0, 'the act before it stays');
  }),
  flow('run and pause, and two speeds, pressed faster than the simulator tells', async ({ mock, page }) => {
    await has_world(page);
    await until('it can run', () => page.locator('#run').isEnabled());
    mock.holds = ({ name }) => name === 'run';
    await page.locator('.world canvas').focus();
    await page.keyboard.press('Space');
    await page.keyboard.press('Space');
    await until('run', () => asked(mock, 'run').length === 1);
    await until('pause', () => asked(mock, 'pause').length === 1);
    for (const speed of ['3', '1']) {
      await page.locator('#speed').fill(speed);
      await page.keyboard.press('Enter');
    }
    await until('both speeds', () => asked(mock, 'speed').length === 2);
    same(asked(mock, 'speed').map((m) => m.args.rtf), [3, 1], 'speeds');
    mock.release_all();
  }),
  flow('a component that takes long to activate keeps no other waiting', async ({ mock, page }) => {
    await has_world(page);
    mock.say({ ...demo_system(), components: demo_system().components.map((c) => ({ ...c, state: 'Inactive' })) });
    await until('inactive', async () => (await page.locator('.diagram .box.state-inactive').count()) === 3);
    mock.holds = ({ name }) => name === 'activate';
    await page.locator('#activate-all').click();
    await held(mock, 'activate', 3);
    mock.release_all();
  }),
  flow('a server that is late gets the newest velocity, and not all that were wanted', async ({ mock, page }) => {
    await has_world(page);
    await choose(page, 'model', 'pioneer2dx');
    await page.locator('.world canvas').focus();
    await page.keyboard.press('g');
    await until('begun', () => asked(mock, 'drive').length > 1);
    mock.holds = ({ name }) => name === 'drive';
    await page.keyboard.down('w');
    await held(mock, 'drive');
    const before = asked(mock, 'drive').length;
    await page.keyboard.up('w');
    await page.keyboard.down('d');
    await page.keyboard.up('d');
    await page.waitForTimeout(400); // four times as long as between two commands
    same(asked(mock, 'drive').length, before, 'commands while none is answered');
    mock.holds = () => false;
    mock.release();
    await until('it stands', () => asked(mock, 'drive').length > before);
    same(asked(mock, 'drive')[before].args.velocity.map(Math.abs), [0, 0, 0], 'the next one');
    await page.locator('.stick').focus();
    await page.keyboard.press('Escape');
  }),
  flow('a model that is dragged is put last where it was let go', async ({ mock, page }) => {
    await has_world(page);
    await page.evaluate(() => { window.studio.world.follow('pioneer2dx'); window.studio.world.hands.set_tool('move'); window.studio.world.draw(); });
    const box = await page.locator('.world canvas').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    mock.holds = ({ name }) => name === 'set_pose';
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y + 5, { steps: 2 });
    await held(mock, 'set_pose');
    await page.waitForTimeout(100);
    await page.mouse.move(x + 60, y + 20, { steps: 4 });
    await page.mouse.up();
    await page.evaluate(() => window.studio.wire.request('models'));
    same(asked(mock, 'set_pose').length, 1, 'while the first is not answered');
    mock.release_all();
    await until('the last one', () => asked(mock, 'set_pose').length === 2);
    await until('it can be undone', () => page.evaluate(() => window.studio.store.acts.at(-1)?.undo?.text === 'Put pioneer2dx back'));
  }),
  flow('keys mean what is known, also before it is drawn', async ({ page }) => {
    await has_world(page);
    same(await page.evaluate(() => {
      const search = document.querySelector('.tree input');
      search.focus();
      search.value = 'LaserObs';
      search.dispatchEvent(new Event('input'));
      search.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowDown', bubbles: true, cancelable: true }));
      return document.activeElement.dataset.key;
    }), `component:${avoid}`, 'the row that is found');
    same(await page.evaluate(() => {
      window.studio.store.system.components.reverse();
      window.studio.select(null);
      const { store, diagram } = window.studio;
      store.system = { ...store.system, components: store.system.components.filter((c) => c.instance === 'RTCPosition2d0') };
      diagram.redraw();
      diagram.canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true, cancelable: true }));
      return store.selection?.id;
    }), `${host}/RTCPosition2d0.rtc`, 'the box that is there');
  }),
  flow('a link that is copied holds the view of now', async ({ page }) => {
    await has_world(page);
    const link = await page.evaluate(() => {
      window.studio.world.follow('pioneer2dx');
      document.getElementById('copy-link').click();
      return location.href;
    });
    const other = await page.context().newPage();
    await other.goto(link);
    await has_world(other);
    same(await other.evaluate(() => [window.studio.world.eye.mode, window.studio.world.eye.what, Boolean(window.studio.world.eye.followed)]), ['follow', 'pioneer2dx', true], 'the eye');
    await other.close();
  }),
  flow('the eye goes on following when the scene is another', async ({ mock, page, world }) => {
    await has_world(page);
    await page.evaluate(() => { window.studio.world.follow('pioneer2dx'); window.was = window.studio.world.world; });
    mock.say({ ...world, version: world.version + 1 });
    await until('another scene', () => page.evaluate(() => window.studio.world.world !== window.was));
    check(await page.evaluate(() => window.studio.world.eye.followed === window.studio.world.world.models.get('pioneer2dx').canonical), 'it follows the robot of the scene that is shown');
  }),
  flow('a simulator that comes instead of another has a scene of its own, also with the same name and version', async ({ mock, page, world }) => {
    await has_world(page);
    const note = () => page.evaluate(() => { window.was = window.studio.world.world; });
    const is_same = () => page.evaluate(() => window.studio.world.world === window.was);
    await note();
    mock.say({ ...world, birth: '1' });
    await until('the scene of the first', async () => !(await is_same()));
    await note();
    const fetched = asked(mock, '/world.glb').length;
    mock.say({ ...world, birth: '1', models: world.models.slice(1) });
    await page.evaluate(() => window.studio.wire.request('models'));
    same(asked(mock, '/world.glb').length, fetched, 'scenes that were fetched');
    mock.say({ ...world, birth: '2' });
    await until('the scene of the second', async () => !(await is_same()));
  }),
  flow('a model that has moved while the scene was on its way is where it went', async ({ mock, page, world }) => {
    await has_world(page);
    const index = await page.evaluate(() => window.studio.world.world.links.findIndex((l) => l.name === 'pioneer2dx::chassis'));
    mock.holds_file = (method, path) => path === '/world.glb';
    mock.say({ ...world, birth: 'another' });
    await held(mock, '/world.glb');
    mock.say(poses(world.version, [[0, 0, 0, 0]], true), false);
    mock.say(poses(world.version, [[index, 1, 2, 0.1]]), false);
    mock.say(poses(world.version, [[0, 0, 0, 0]]), false);
    await page.evaluate(() => { window.was = window.studio.world.world; return window.studio.wire.request('models'); });
    mock.release_all();
    await until('another scene', () => page.evaluate(() => window.studio.world.world !== window.was));
    const place = await page.evaluate((i) => window.studio.world.world.links[i].position.toArray(), index);
    same(place.map((v) => Math.round(v * 1e3) / 1e3), [1, 2, 0.1], 'where it is');
  }),
  flow('a recording shows the moment that was chosen last, whole when its world has come', async ({ mock, page }) => {
    mock.holds = ({ name }) => name === 'look';
    mock.say(hello({ recording: { file: 'a.mcap', from: 0, to: 10, step: 0.02, damage: '', states: {}, lines: [], lines_left_out: 0 } }));
    await held(mock, 'look');
    mock.say(demo_system());
    mock.say(await world_of(glb));
    await has_world(page);
    await page.evaluate(() => window.studio.playback.seek(4));
    await page.evaluate(() => window.studio.playback.seek(7));
    same(asked(mock, 'look').length, 1, 'one at a time');
    mock.release();
    await held(mock, 'look');
    same(asked(mock, 'look')[1].args, { time: 7, whole: true }, 'the newest, whole');
    await drawn(page);
    await becomes(() => page.evaluate(() => document.querySelector('.scrub').value), '7', 'the slider stays in the hand');
    mock.release_all();
    await until('shown', async () => (await page.locator('.clock').textContent()) === '7.000 s');
  }, () => []),
];

run(flows, set_up);
