// The system in the page, and how it is wired, in front of a stand-in of the server: diagram_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page.
import { demo_system, fleet, hello, many_components, Mock, time } from './mock.mjs';
import { asked, avoid, built, choose, glb, host, laser, set_up } from './mock_page.mjs';
import { becomes, check, is_ready, open, run, same, until } from './rig.mjs';

const flows = [
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
];

run(flows, set_up, async (shared) => shared?.mock.stop());
