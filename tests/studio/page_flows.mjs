// The page alone, in front of a stand-in of the server: page_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page, flow after flow.
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { component, demo_system, hello, Mock, time, world_of } from './mock.mjs';
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
