// The joints of a selected model, in front of a stand-in of the server: joint_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page.
import { asked, choose, set_up } from './mock_page.mjs';
import { becomes, check, run, same, until } from './rig.mjs';

const joint = (name, id, kind, lower, upper) => ({ name, id, kind, lower, upper, max_velocity: 2, max_effort: 200, rest: 0 });
const joints = [joint('elbow', 0, 1, -1, 2), joint('lift', 1, 2, 0, 0.5), joint('wheel', 2, 1, null, null)];
const iface = { type: 'joints', name: 'pioneer2dx::joints', model: 'pioneer2dx', info: { model: 'pioneer2dx', count: 3, joints } };
const state = (position, more = {}) => ({ position, velocity: 0, effort: 0, target: 0, mode: 0, status: 0, ...more });

// Samples go to all that watch the joints now.
function sample(mock, states) {
  const gone = new Set(asked(mock, 'unwatch').map((m) => m.args.watch));
  const watches = asked(mock, 'watch').filter((m) => m.args.topic === 'joints:pioneer2dx::joints' && !gone.has(m.args.watch));
  for (const { args } of watches) mock.say({ op: 'values', watch: args.watch, t: [1], value: { commanded: 0, joints: states } }, false);
}

const moves = (mock) => asked(mock, 'move_joints').map((m) => m.args.joints);
const row = (page, name) => page.locator('.joint', { has: page.locator(`label:text-is("${name}")`) });
const at_rest = [state(Math.PI / 6), state(0.25), state(0)];

async function begin(shared) {
  const { page, mock, world } = shared;
  mock.say({ ...world, ifaces: [...world.ifaces, iface] });
  mock.say({ op: 'signals', signals: [{ topic: '/sim/joints/pioneer2dx/joints', kind: 'iface', type: 'joints', model: 'pioneer2dx' }] });
  await page.evaluate(() => window.studio.select(null));
  await choose(page, 'model', 'pioneer2dx');
  await until('a row for each joint', async () => (await page.locator('.joint').count()) === 3);
  // Again and again, as a simulator does: the page may watch anew when it has its rows.
  await until('where they are', async () => {
    sample(mock, at_rest);
    return (await row(page, 'elbow').locator('.actual').textContent()) === '30.0°';
  });
}

// Presses the slider at a share of its width and holds it.
async function press(page, name, share) {
  const slider = row(page, name).locator('input[type=range]');
  await slider.scrollIntoViewIfNeeded();
  const box = await slider.boundingBox();
  await page.mouse.move(box.x + box.width * share, box.y + box.height / 2);
  await page.mouse.down();
}

const flows = [
  ['joints are shown with positions, limits and units: degrees for those that turn, metres for those that slide', async (shared) => {
    await begin(shared);
    const { page, mock } = shared;
    await becomes(() => page.locator('.joint .actual').allTextContents(), ['30.0°', '0.250 m', '0.0°'], 'positions');
    same(await page.locator('.joint .limits').allTextContents(), ['-57.3° … 114.6°', '0.000 m … 0.500 m', '-180.0° … 180.0°'], 'limits');
    sample(mock, [state(0.1, { target: 0.5, mode: 1, status: 1 }), state(0.25, { mode: 5, status: 2 }), state(0)]);
    await until('mode and target', async () => (await row(page, 'elbow').textContent()).includes('→ 28.6°, position, moving'));
    await until('a brake', async () => (await row(page, 'lift').textContent()).includes('brake, braked'));
    await row(page, 'elbow').locator('button[title^="Plot"]').click();
    await until('a plot in degrees', async () => (await page.locator('.plot .legend').allTextContents()).some((text) => text.includes('joints[0].position [°]')));
    same(moves(mock).length, 0, 'commands of one who looks');
  }],
  ['a slider commands its joint until the joint has arrived, and then it is left to its brake', async (shared) => {
    await begin(shared);
    const { page, mock } = shared;
    await press(page, 'elbow', 0.9);
    await until('commands while it is held', () => moves(mock).length > 2);
    const wanted = moves(mock).at(-1).elbow;
    check(wanted.mode === 'position' && wanted.value > 1.5 && wanted.value < 2, `target ${JSON.stringify(wanted)}`);
    sample(mock, [state(wanted.value, { target: wanted.value, mode: 1 }), ...at_rest.slice(1)]);
    await until('the sample is shown', async () => (await row(page, 'elbow').textContent()).includes('position, idle'));
    check(asked(mock, 'release').length === 0, 'it is held');
    await page.mouse.up();
    await until('renewed until it arrives', async () => { const n = moves(mock).length; await new Promise((resolve) => setTimeout(resolve, 400)); return moves(mock).length > n; });
    await until('the status line', async () => (await page.locator('footer .act').textContent()).includes('Move elbow of pioneer2dx'));
    sample(mock, [state(wanted.value, { target: wanted.value, mode: 1 }), ...at_rest.slice(1)]);
    await until('released', () => asked(mock, 'release').at(-1)?.args.iface === 'pioneer2dx::joints');
    const count = moves(mock).length;
    await new Promise((resolve) => setTimeout(resolve, 500));
    same(moves(mock).length, count, 'commands after it');
  }],
  ['a velocity is commanded as long as its slider is held', async (shared) => {
    await begin(shared);
    const { page, mock } = shared;
    await page.locator('#joint-mode').selectOption('velocity');
    const before = asked(mock, 'release').length;
    await press(page, 'lift', 0.97);
    await until('a velocity', () => moves(mock).at(-1)?.lift?.mode === 'velocity' && moves(mock).at(-1).lift.value > 1.5);
    await page.mouse.up();
    await until('released', () => asked(mock, 'release').length === before + 1);
    await becomes(() => row(page, 'lift').locator('input[type=range]').inputValue(), '0', 'the slider');
    await page.locator('#joint-mode').selectOption('position');
  }],
  ['a joint is freed and braked; what is commanded ends when another model is selected', async (shared) => {
    await begin(shared);
    const { page, mock } = shared;
    const free = row(page, 'wheel').getByRole('button', { name: /^Free/ });
    await free.click();
    await until('free', () => moves(mock).at(-1)?.wheel?.mode === 'free');
    await becomes(() => free.getAttribute('aria-pressed'), 'true', 'the button');
    await row(page, 'lift').getByRole('button', { name: /^Brake/ }).click();
    await until('brake', () => moves(mock).some((one) => one.lift?.mode === 'brake'));
    check(moves(mock).at(-1).wheel?.mode === 'free' || (await free.getAttribute('aria-pressed')) === 'true', 'the other stays free');
    const before = asked(mock, 'release').length;
    await page.evaluate(() => window.studio.select(null));
    await until('released', () => asked(mock, 'release').length === before + 1);
  }],
  ['a typed value moves a joint; what the server refuses is shown beside the joints', async (shared) => {
    await begin(shared);
    const { page, mock } = shared;
    const field = row(page, 'lift').locator('input[type=number]');
    await field.fill('0.4');
    await page.keyboard.press('Enter');
    await until('metres', () => moves(mock).at(-1)?.lift?.value === 0.4);
    const usual = mock.answer;
    mock.answer = (message) => (message.name === 'move_joints' ? { error: 'iface pioneer2dx::joints: has gone' } : usual(message));
    await page.locator('.joints .problem', { hasText: 'has gone' }).waitFor();
    mock.answer = usual;
  }],
  ['one who may only look has no buttons, and sliders that do not move', async (shared) => {
    const { page, mock } = shared;
    mock.say({ op: 'hello', version: '0', read_only: true, name_server: 'localhost:2809', server_id: 0 });
    await begin(shared);
    await becomes(() => page.locator('.joint button:not([title^="Plot"])').count(), 0, 'buttons');
    await until('the slider is disabled', () => row(page, 'lift').locator('input[type=range]').isDisabled());
    mock.say({ op: 'hello', version: '0', read_only: false, name_server: 'localhost:2809', server_id: 0 });
  }],
];

run(flows, set_up, async (shared) => shared?.mock.stop());
