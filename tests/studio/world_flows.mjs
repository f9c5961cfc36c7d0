// The world in the page, and what is done to it, in front of a stand-in of the server: world_flows.mjs BIN_DIR SOURCE_DIR. One browser, one page.
import { poses, time } from './mock.mjs';
import { asked, choose, laser, set_up } from './mock_page.mjs';
import { becomes, check, drawn, run, same, until } from './rig.mjs';

const flows = [
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
];

run(flows, set_up, async (shared) => shared?.mock.stop());
