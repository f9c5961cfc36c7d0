// What rtse and simctl can do has a button, in front of a stand-in of the server: act_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page.
import { component, demo_system } from './mock.mjs';
import { asked, avoid, choose, detail, host, laser, set_up } from './mock_page.mjs';
import { becomes, check, drawn, run, same, until } from './rig.mjs';

const flows = [
  ['a connection may have further ends, and an id', async ({ page, mock }) => {
    const third = component('Third0', 'LaserObstacleAvoid', 'Inactive', [['range', 'in', 'IDL:RTC/RangeData:1.0']]);
    mock.say({ ...demo_system(), components: [...demo_system().components, third] });
    await choose(page, 'port', `${laser}:range`);
    await page.locator('#connect').click();
    await page.locator('dialog[open] .ends summary').click();
    await page.locator('#connect-id').fill('mine');
    await page.locator('#connect-further').selectOption(`${third.path}:range`);
    await page.locator('dialog[open] button.main').click();
    await until('connect', () => asked(mock, 'connect').at(-1)?.args.id === 'mine');
    same(asked(mock, 'connect').at(-1).args.ports, [`${laser}:range`, `${avoid}:range`, `${third.path}:range`], 'its ends');
    mock.say(demo_system());
  }],
  ['parameters have the widgets that they ask for', async ({ page, mock }) => {
    await choose(page, 'component', laser);
    await until('sets', async () => (await page.locator('.inspector .slider input[type=range]').count()) === 1);
    await becomes(() => page.locator('.inspector .choices input').count(), 3, 'checkboxes');
    await becomes(() => page.locator('.inspector select option').allTextContents(), ['left', 'right'], 'choice');
    await page.locator('.inspector .slider input[type=number]').fill('75');
    await page.keyboard.press('Tab');
    await until('set', () => asked(mock, 'set_configuration').some((m) => m.args.values.max_turn === '75'));
    await page.locator('.inspector .choices input').nth(1).check();
    await until('both days', () => asked(mock, 'set_configuration').some((m) => m.args.values.days === 'mon,tue'));
  }],
  ['a component joins simulated time and leaves it; all of its connections are cut', async ({ page, mock }) => {
    await choose(page, 'component', avoid);
    await page.locator('#act-join_time').click();
    await page.locator('#join-phase').selectOption('2');
    await page.locator('#join-rate').fill('50');
    await page.locator('dialog[open] button.main').click();
    await until('join', () => asked(mock, 'join_time').length === 1);
    same(asked(mock, 'join_time')[0].args, { path: avoid, phase: 2, rate: 50 }, 'how');
    mock.say({ ...demo_system(), components: demo_system().components.map((c) => ({ ...c, in_simulated_time: c.path === avoid })) });
    await page.locator('#act-leave_time').click();
    await until('leave', () => asked(mock, 'leave_time').at(-1)?.args.path === avoid);
    await page.locator('#act-disconnect_all').click();
    const cut = demo_system().connections.filter((c) => c.ports.some((p) => p.startsWith(`${avoid}:`))).map((c) => c.id);
    await until('cut', () => asked(mock, 'disconnect').length === cut.length);
    same(asked(mock, 'disconnect').map((m) => m.args.id).sort(), cut.sort(), 'which');
    await until('both can be undone', () => page.evaluate((n) => window.studio.store.acts.slice(-n).every((one) => one.undo), cut.length));
    const before = asked(mock, 'connect').length;
    await page.keyboard.press('Control+z');
    await until('all come back at once', () => asked(mock, 'connect').length === before + cut.length);
    mock.say(demo_system());
  }],
  ['what a component refuses can be set all the same', async ({ page, mock }) => {
    const usual = mock.answer;
    mock.answer = (message) => (message.name === 'set_configuration' && !message.args.force ? { error: 'parameter count cannot be 99, expected at most 9' } : usual(message));
    await choose(page, 'component', laser);
    await until('its details', () => page.evaluate((path) => window.studio.store.details.has(path), laser));
    await drawn(page);
    const field = page.locator('.inspector label:has-text("max_turn") + * input[type=number]');
    await field.fill('999');
    await page.keyboard.press('Tab');
    await page.locator('.inspector button', { hasText: 'Set anyway' }).click();
    await until('by force', () => asked(mock, 'set_configuration').some((m) => m.args.force && m.args.values.max_turn === '999'));
    mock.answer = usual;
    await choose(page, 'component', avoid);
  }],
  ['each of several contexts has a rate and a state of its own', async ({ page, mock }) => {
    const [own] = demo_system().components[0].contexts;
    const contexts = [own, { ...own, index: 1, owned: false, state: 'Inactive' }];
    const usual = mock.answer;
    mock.answer = (message) => (message.name === 'component' && message.args.path === laser ? { result: { ...detail(laser), contexts } } : usual(message));
    mock.say({ ...demo_system(), components: demo_system().components.map((c) => (c.path === laser ? { ...c, contexts } : c)) });
    await choose(page, 'component', laser);
    await page.locator('#activate-in-1').click();
    await until('activated there', () => asked(mock, 'activate').at(-1)?.args.context === 1);
    await page.locator('#deactivate-in-0').click();
    await until('deactivated there', () => asked(mock, 'deactivate').at(-1)?.args.context === 0);
    mock.answer = usual;
    mock.say(demo_system());
  }],
  ['the motors of a robot are switched, its odometry begins anew', async ({ page, mock }) => {
    await choose(page, 'iface', 'position2d:pioneer2dx::position2d');
    await page.locator('#motors-off').click();
    await until('off', () => asked(mock, 'set_motors').at(-1)?.args.on === false);
    await page.keyboard.press('Control+z');
    await until('on', () => asked(mock, 'set_motors').at(-1)?.args.on === true);
    await page.locator('#reset-odometry').click();
    await until('odometry', () => asked(mock, 'reset_odometry').at(-1)?.args.iface === 'pioneer2dx::position2d');
  }],
  ['names whose components are gone are forgotten at once', async ({ page, mock }) => {
    await page.locator('#forget-dead').waitFor({ state: 'hidden' });
    mock.say({ ...demo_system(), components: demo_system().components.map((c) => ({ ...c, state: 'Unknown', problem: 'does not answer' })) });
    await page.locator('#forget-dead').click();
    await until('forgotten', () => asked(mock, 'forget_dead').length === 1);
    mock.say(demo_system());
  }],
  ['a value is written to a port, beginning with zeros of its type', async ({ page, mock }) => {
    await choose(page, 'port', `${host}/RTCPosition2d0.rtc:velocity`);
    await page.locator('#inject').click();
    await until('the zeros', async () => (await page.locator('#inject-value').inputValue()).includes('"vx": 0'));
    await page.locator('#inject-value').fill('{"data": {"vx": 0.2}}');
    await page.locator('dialog[open] button.main').click();
    await until('inject', () => asked(mock, 'inject').length === 1);
    same(asked(mock, 'inject')[0].args, { port: `${host}/RTCPosition2d0.rtc:velocity`, value: '{"data":{"vx":0.2}}' }, 'what');
  }],
  ['a model is chosen from the list and spawned', async ({ page, mock }) => {
    await page.locator('.world canvas').focus();
    await page.keyboard.press('Insert');
    await until('the list', async () => (await page.locator('.models button').count()) === 3);
    await page.locator('#spawn-model').fill('pio');
    await until('those that fit', async () => (await page.locator('.models button').count()) === 2);
    await page.locator('.models button', { hasText: /^pioneer2dx$/ }).click();
    await page.locator('dialog[open] button.main').click();
    await until('spawn', () => asked(mock, 'spawn').at(-1)?.args.model === 'pioneer2dx');
  }],
  ['a profile is loaded, started, stopped, torn down or compared', async ({ page, mock }) => {
    for (const [way, name] of [['Load', 'open_profile'], ['Start', 'start_system'], ['Stop', 'stop_system'], ['Tear down', 'teardown'], ['Compare', 'check_profile']]) {
      await page.locator('input[type=file]').setInputFiles({ name: 'a.xml', mimeType: 'text/xml', buffer: Buffer.from('<rts/>') });
      await page.locator('dialog[open] .way', { has: page.locator(`strong:text-is("${way}")`) }).click();
      await page.locator('dialog[open] button.main').click();
      await until(name, () => asked(mock, name).at(-1)?.args.xml === '<rts/>');
    }
    await page.locator('.differences li', { hasText: 'connection range' }).waitFor();
    await page.locator('dialog[open] button.main').click();
  }],
  ['a model is shown with its links, a picture of the view is saved', async ({ page, mock }) => {
    await choose(page, 'model', 'pioneer2dx');
    await page.locator('.links summary', { hasText: '2 links' }).click();
    await page.locator('.links li', { hasText: 'left_wheel' }).waitFor();
    const [saved] = await Promise.all([page.waitForEvent('download'), page.locator('button[aria-label^="Save an image"]').click()]);
    same(saved.suggestedFilename(), 'world.png', 'file');
    check(asked(mock, 'screenshot')[0].args.pose.length === 7, 'the eye');
  }],
  ['what contexts do is told while it is looked at', async ({ page, mock }) => {
    await page.locator('#tab-step').click();
    await until('a row', async () => (await page.locator('.contexts tbody tr').textContent()).includes('RTCLaser0'));
    await page.locator('#tab-plots').click();
    await until('no more', async () => { const count = asked(mock, 'statistics').length; await new Promise((resolve) => setTimeout(resolve, 1500)); return asked(mock, 'statistics').length === count; });
  }],
  ['results of a campaign are sorted and filtered, and a failed row opens its recording', async ({ page, mock }) => {
    const usual = mock.answer;
    const csv = 'row,seed,component/Laser0/gain,passed,problem,state,simulated_s,wall_s,clearance\r\n1,1,0.3,1,,05bd,4,0.6,1.5\r\n2,1,0.5,0,"path ""a"", too short",05bd,4,0.6,0.25\r\n10,1,0.7,0,too short,05bd,4,0.6,1\r\n';
    mock.answer = (message) => {
      if (message.name === 'recordings' || message.name === 'campaigns') return { result: { folder: '/there', open: '', may_open: true, files: message.name === 'campaigns' ? [{ file: 'plan.db', size: 9, time: 1 }] : [] } };
      return message.name === 'campaign' ? { result: { csv, recordings: [{ row: 2, file: 'plan.runs/row-2-ab/run.mcap' }] } } : usual(message);
    };
    await page.locator('#open-recording').click();
    await page.locator('#campaigns button', { hasText: 'plan.db' }).click();
    const table = page.locator('dialog[open] .campaign');
    const rows = () => table.locator('tbody tr').evaluateAll((all) => all.map((row) => row.cells[0].textContent));
    await until('its rows', async () => (await rows()).length === 3);
    await becomes(() => page.locator('dialog[open] [role=status]').textContent(), '3 rows: 1 passed, 2 failed', 'summary');
    same(await table.locator('thead th').allTextContents(), ['row', 'seed', 'Laser0/gain', 'problem', 'simulated_s', 'clearance'], 'columns');
    check((await table.locator('tbody tr').nth(1).textContent()).includes('path "a", too short'), 'the problem');
    await table.locator('th button', { hasText: 'clearance' }).click();
    await becomes(rows, ['✗ failed 2', '✗ failed 10', '✓ passed 1'], 'by numbers');
    await page.locator('#campaign-failed').check();
    await becomes(rows, ['✗ failed 2', '✗ failed 10'], 'failed rows');
    await table.locator('button', { hasText: /^2$/ }).click();
    await until('opened', () => asked(mock, 'open_recording').at(-1)?.args.file === 'plan.runs/row-2-ab/run.mcap');
    await becomes(() => page.locator('dialog[open]').count(), 0, 'dialogs');
    mock.answer = usual;
  }],
  ['a refusal is one line that stays', async ({ page }) => {
    await choose(page, 'manager', `${host}/rtcd.mgr`);
    await page.locator('#manager-create').click();
    await page.locator('#ask-text').fill('Nonsense');
    await page.keyboard.press('Enter');
    await until('refusal', async () => (await page.locator('footer .act').textContent()).includes('no component of type Nonsense'));
  }],
];

run(flows, set_up, async (shared) => shared?.mock.stop());
