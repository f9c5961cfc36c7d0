// The tip of an arm is dragged in the world, with a real simulator: tip_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR. One browser, one page.
import { join } from 'node:path';
import { becomes, check, has_world, is_ready, open, Rig, run, same, until } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);

async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  const shared = { browser, rig };
  await rig.claim();
  await rig.naming();
  await rig.server('worlds/arm.sdf');
  shared.studio = await rig.studio();
  shared.page = await open(browser, shared.studio.url);
  await is_ready(shared.page);
  await has_world(shared.page);
  return shared;
}

const place = (page) => page.evaluate(() => window.studio.world.hands.tip.place());
const has_arrows = (page) => until('arrows at the tip', () => place(page));
const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));
const hand = async (rig) => JSON.parse(await rig.simctl('--json', 'pose', 'arm::hand')).position;
const joint_states = async (rig) => JSON.parse(await rig.simctl('--json', 'echo', 'arm::joints', '-n', '1')).joints;
const rests = (rig) => until('the arm rests', async () => (await joint_states(rig)).every(({ velocity }) => Math.abs(velocity) < 1e-3));

// A point of the world on the screen.
const on_screen = (page, point) => page.evaluate((p) => {
  const { world } = window.studio, at = world.eye.target.clone().fromArray(p).project(world.eye.camera), box = world.canvas.getBoundingClientRect();
  return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
}, point);

// From the side: nothing is before the hand.
const look = (page) => page.evaluate(() => { const { world } = window.studio; world.follow('arm'); Object.assign(world.eye, { distance: 2.2, azimuth: -Math.PI / 2 }); world.draw(); });

async function choose_tip(page) {
  await look(page);
  await page.evaluate(() => window.studio.select({ kind: 'model', id: 'arm' }));
  const button = page.locator('#joint-tip');
  await button.waitFor();
  if ((await button.getAttribute('aria-pressed')) !== 'true') await button.click();
  await has_arrows(page);
}

// By the square in the middle, in the plane of the screen. Returns where it was dragged to.
async function drag(page, to) {
  await page.evaluate(() => window.studio.world.draw());
  const [x, y] = await on_screen(page, await place(page));
  await page.mouse.move(x + 1, y, { steps: 3 });
  await until('the arrows are under the mouse', () => page.evaluate(() => window.studio.world.hands.tip.is_under_mouse()));
  await page.mouse.down();
  await page.mouse.move(x + to[0], y + to[1], { steps: 6 });
  const wanted = await page.evaluate(() => window.studio.world.hands.tip.proxy.position.toArray());
  await page.mouse.up();
  return wanted;
}

const flows = [
  ['the tip of an arm follows its arrows, and the joints are let go when they have arrived', async ({ page, rig }) => {
    await choose_tip(page);
    if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'tip.png') });
    await rests(rig);
    const before = await place(page), was = await hand(rig);
    const wanted = await drag(page, [25, 10]);
    check(distance(wanted, before) > 0.05, `dragged from ${before} to ${wanted}`);
    await until('the hand has moved', async () => distance(await hand(rig), was) > 0.04);
    await until('the tip is where it was dragged', async () => distance(await place(page), wanted) < 0.01);
    const commanded = async () => JSON.parse(await rig.simctl('--json', 'echo', 'arm::joints', '-n', '1')).commanded;
    await becomes(commanded, 0, 'joints that are commanded still');
    await until('the status line', async () => (await page.locator('footer .act').textContent()).includes('Move the tip of arm'));
  }],
  ['a place out of reach: the arm comes as near as it can, within its limits', async ({ page, rig }) => {
    await choose_tip(page);
    await rests(rig);
    const far = await page.evaluate(() => {
      const { tip } = window.studio.world.hands, arm = tip.arm, far = tip.proxy.position.clone().set(3, 0, 1.2);
      const at = (positions) => arm.offset.clone().applyMatrix4(arm.chain.frame(positions, arm.base));
      const positions = arm.chain.reach(arm.base, arm.offset, arm.positions, far), shoulder = far.clone().set(0, 0, 0.95);
      const inside = arm.chain.joints.every(({ lower, upper }, i) => positions[i] >= (lower ?? -Infinity) && positions[i] <= (upper ?? Infinity));
      const again = arm.chain.reach(arm.base, arm.offset, positions, at(positions));
      return { at: at(positions).toArray(), way: far.sub(shoulder).normalize().toArray(), shoulder: shoulder.toArray(), inside, still: Math.max(...again.map((value, i) => Math.abs(value - positions[i]))) };
    });
    check(far.inside, 'limits');
    check(far.still < 1e-3, `a place that is reached moves nothing: ${far.still}`);
    const out = far.at.map((value, i) => value - far.shoulder[i]), length = Math.hypot(...out);
    check(length > 0.75, `stretched: ${length} m`);
    check(out.reduce((sum, value, i) => sum + value * far.way[i], 0) / length > 0.999, `towards it: ${out}`);
  }],
  ['a click on the last link shows its arrows, one on another model ends them', async ({ page, rig }) => {
    await choose_tip(page);
    await rests(rig);
    const tip = await place(page);
    await page.locator('#joint-tip').click();
    await becomes(() => place(page), null, 'arrows');
    await page.evaluate(() => window.studio.select(null));
    await look(page);
    const [x, y] = await on_screen(page, tip);
    await page.mouse.click(x, y);
    await becomes(() => page.evaluate(() => window.studio.store.selection?.id), 'arm', 'selection');
    await has_arrows(page);
    await page.evaluate(() => window.studio.select({ kind: 'model', id: 'table' }));
    await becomes(() => place(page), null, 'arrows');
  }],
  ['one who may only look has no arrows', async ({ rig, browser }) => {
    const studio = await rig.studio('--read-only');
    const page = await open(browser, studio.url);
    await is_ready(page);
    await has_world(page);
    await page.evaluate(() => window.studio.select({ kind: 'model', id: 'arm' }));
    await until('the joints', async () => (await page.locator('.joint').count()) === 8);
    same(await page.locator('#joint-tip').count(), 0, 'buttons');
    await page.context().close();
    await rig.end(studio);
  }],
];

run(flows, set_up, async (shared) => shared?.rig.end_all());
