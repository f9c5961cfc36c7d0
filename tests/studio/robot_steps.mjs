// Flows of a robot in a system that runs: seen, put, pushed, driven, spawned, in its past. Each begins with what the one before has left.
import { join } from 'node:path';
import { becomes, check, until } from './rig.mjs';
import { drives, in_state, pull, robot, stands } from './system_rig.mjs';

export const flows = [
  ['the last minutes of a live run are scrolled back to', async ({ page, rig }) => {
    const shown = () => page.evaluate((name) => [window.studio.store.time?.sim_time, ...window.studio.world.world.models.get(name).canonical.position.toArray()], robot);
    const far = async ([, x, y]) => { const [, a, b] = await shown(); return Math.hypot(a - x, b - y); };
    const look = (time) => page.locator('.scrub').evaluate((slider, to) => {
      slider.value = String(to);
      slider.dispatchEvent(new Event('input', { bubbles: true }));
    }, time);
    const can_look = (time) => until(`${time} s are behind`, () => page.locator('.scrub').evaluate((slider, to) => Number(slider.max) > to + 0.5, time));
    await page.locator('#activate-all').click();
    await in_state(page, 'active', 3);
    await drives(rig);
    const then = await shown();
    await can_look(then[0]);
    await page.locator('#deactivate-all').click();
    await in_state(page, 'inactive', 3);
    const other = [0, 3.5, 3.5];
    await rig.simctl('pose', robot, '3.5', '3.5', '0');
    await until('it is somewhere else', async () => (await far(other)) < 0.5);
    await can_look((await shown())[0]);
    await look(then[0]);
    await until('it is where it was', async () => (await far(then)) < 1.5);
    await in_state(page, 'active', 3);
    // What comes meanwhile is kept.
    const before = await page.evaluate(() => window.studio.store.time?.sim_time);
    await can_look(before + 1);
    await look(before + 1);
    await until('it is somewhere else', async () => (await far(other)) < 0.5);
    await in_state(page, 'inactive', 3);
    await becomes(() => page.locator('#live').getAttribute('aria-pressed'), 'false', 'not live');
    await page.locator('#live').click();
    await until('now', async () => (await page.locator('#live').getAttribute('aria-pressed')) === 'true' && (await far(other)) < 0.5);
    await rig.simctl('pose', robot, '-4.5', '-4.5', '0.785');
  }],
  ['selecting the robot marks its components', async ({ page }) => {
    await page.evaluate((id) => window.studio.select({ kind: 'model', id }), robot);
    await until('RTCPosition2d0 is marked', async () => (await page.locator('.diagram .box.related').count()) >= 1);
  }],
  ['contacts of the selected robot are seen', async ({ page }) => {
    await page.evaluate((id) => window.studio.select({ kind: 'model', id }), robot);
    await page.locator('button[aria-label="Contacts of the selected model"]').click();
    await until('its wheels touch the ground', () => page.evaluate(() => window.studio.world.contacts.count >= 2));
    if (process.env.STUDIO_PICTURES) {
      await page.evaluate((name) => { window.studio.world.follow(name); window.studio.world.draw(); }, robot);
      await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'contacts.png') });
    }
    await page.locator('button[aria-label="Contacts of the selected model"]').click();
    await until('none', () => page.evaluate(() => window.studio.world.contacts.count === 0));
  }],
  ['a robot is put somewhere else by dragging, and pushed', async ({ page, rig }) => {
    const place = async () => JSON.parse(await rig.simctl('--json', 'pose', robot)).position;
    await rig.simctl('pause');
    await page.evaluate((name) => { window.studio.world.follow(name); window.studio.world.hands.set_tool('move'); window.studio.select(null); }, robot); // without arrows above it
    await page.evaluate(() => window.studio.world.draw());
    const before = await place();
    await pull(page, 70);
    await until('it was put', async () => { const now = await place(); return Math.hypot(now[0] - before[0], now[1] - before[1]) > 0.05; });
    const put = await place();
    await until('the page knows that it was', () => page.evaluate(() => window.studio.store.acts.at(-1).undo?.text === 'Put pioneer2dx back'));
    await page.keyboard.press('Control+z');
    await until('it is back by undo', async () => { const now = await place(); return Math.hypot(now[0] - before[0], now[1] - before[1]) < 0.01; });
    check(Math.hypot(put[0] - before[0], put[1] - before[1]) > 0.05, 'it had been put');
    // With Ctrl it turns where it is.
    await page.evaluate((name) => window.studio.world.follow(name), robot);
    await until('it is seen there', () => page.evaluate(([name, x]) => { window.studio.world.draw(); return Math.abs(window.studio.world.world.models.get(name).canonical.position.x - x) < 0.01; }, [robot, before[0]]));
    const yaw = async () => JSON.parse(await rig.simctl('--json', 'pose', robot)).yaw;
    const straight = await yaw();
    await page.evaluate(() => { window.studio.select(null); window.studio.world.draw(); });
    await page.keyboard.down('Control');
    await pull(page, 50);
    await page.keyboard.up('Control');
    await until('it has turned', async () => Math.abs((await yaw()) - straight) > 0.3);
    const now = await place();
    check(Math.hypot(now[0] - before[0], now[1] - before[1]) < 0.02, `it has stayed: ${now}`);
    await page.evaluate(() => { window.studio.world.hands.set_tool('move'); window.studio.world.whole(); });
    await rig.simctl('run');
  }],
  ['a model whose link has a pose of its own is put back where it was', async ({ page, rig }) => {
    await rig.simctl('pause');
    const shape = '<geometry><box><size>0.6 0.6 0.6</size></box></geometry>';
    await rig.simctl('spawn', `<sdf version="1.9"><model name="crate"><link name="l"><pose>1 0 0.3 0 0 0.5</pose><collision name="c">${shape}</collision><visual name="v">${shape}</visual></link></model></sdf>`, '--pose', '2 -3 0.2');
    const place = async () => { const { position, yaw } = JSON.parse(await rig.simctl('--json', 'pose', 'crate')); return [...position, yaw]; };
    const before = await place();
    await until('in the world', () => page.evaluate(() => window.studio.world.world.models.has('crate')));
    await page.evaluate(() => { window.studio.select({ kind: 'model', id: 'crate' }); window.studio.world.follow('crate'); window.studio.world.hands.set_tool('move'); window.studio.world.draw(); });
    await until('its pose is shown', async () => (await page.locator('.inspector dl.values dd').allTextContents()).slice(0, 3).join(' ') === '2.000 m -3.000 m 0.000 m');
    await page.evaluate(() => window.studio.select(null)); // without arrows above it
    await page.evaluate(() => window.studio.world.draw());
    await pull(page, 60);
    await until('the page knows that it was put', () => page.evaluate(() => window.studio.store.acts.at(-1).undo?.text === 'Put crate back'));
    const put = await place();
    check(Math.hypot(put[0] - before[0], put[1] - before[1]) > 0.05 && Math.abs(put[3] - before[3]) < 1e-3, `moved, and not turned: ${put}`);
    await page.keyboard.press('Control+z');
    await until('it is back', async () => (await place()).every((value, i) => Math.abs(value - before[i]) < 1e-3));
    await rig.simctl('delete', 'crate');
    await until('and gone', async () => (await page.locator('.inspector').textContent()).includes('It does not exist now'));
    await page.evaluate(() => { window.studio.world.hands.set_tool('move'); window.studio.world.whole(); });
    await rig.simctl('run');
  }],
  ['keys drive the robot, and it stops without them', async ({ page, rig }) => {
    await page.locator('.world canvas').focus();
    await page.keyboard.press('g');
    await page.keyboard.down('w');
    await drives(rig);
    await page.keyboard.up('w');
    await stands(rig);
    await page.locator('.stick').focus();
    await page.keyboard.press('Escape');
  }],
  ['models are spawned and deleted', async ({ page, rig }) => {
    await page.evaluate(() => window.studio.world.whole());
    await page.locator('button[aria-label="Spawn a model"]').click();
    await until('models to choose from', () => page.locator('#spawn-models option[value="pioneer2dx"]').count());
    await page.locator('#spawn-model').fill('pioneer');
    await page.locator('.models button', { hasText: /^pioneer2dx$/ }).click();
    await page.locator('#spawn-name').fill('second');
    await page.locator('#spawn-pose').fill('3 3 0');
    await page.locator('dialog[open] button.main').click();
    await until('in the world', () => page.evaluate(() => window.studio.world.world.models.has('second')));
    await page.evaluate(() => window.studio.select({ kind: 'model', id: 'second' }));
    await page.locator('.links summary', { hasText: /^\d links$/ }).click();
    await page.locator('.links li', { hasText: 'chassis' }).first().waitFor();
    await until('its velocity', async () => /^-?0\.\d\d .* m\/s$/.test(await page.locator('.inspector dt:text-is("velocity") + dd').textContent()));
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'model.png') });
    await rig.simctl('pause');
    await rig.simctl('pose', 'second', '3', '3.5', '0.7');
    await page.locator('.inspector button:has-text("Delete")').click();
    await until('gone', () => page.evaluate(() => !window.studio.world.world.models.has('second')));
    await page.keyboard.press('Control+z');
    await until('restored', () => page.evaluate(() => window.studio.world.world.models.has('second')));
    const { position, yaw } = JSON.parse(await rig.simctl('--json', 'pose', 'second'));
    check(Math.hypot(position[0] - 3, position[1] - 3.5) < 1e-6 && Math.abs(yaw - 0.7) < 1e-6, `where it was: ${position} ${yaw}`);
    await until('with its ifaces', () => page.evaluate(() => window.studio.store.world.ifaces.some((i) => i.model === 'second')));
    await page.evaluate(() => window.studio.select({ kind: 'model', id: 'second' }));
    await page.locator('.inspector button:has-text("Delete")').click();
    await until('gone again', () => page.evaluate(() => !window.studio.world.world.models.has('second')));
    await rig.simctl('run');
  }],
];
