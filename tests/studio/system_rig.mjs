// A system with all its programs, and what its flows share: naming service, simulator, components, rtm-studio, a page.
import { has_world, is_ready, open, Rig, until } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);
export const robot = 'pioneer2dx';

export async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  const shared = { browser, rig };
  await rig.claim();
  shared.names = await rig.naming();
  shared.world = await rig.server('worlds/obstacle_course.sdf');
  shared.host = rig.host(rig.device('RTCLaser'), rig.device('RTCPosition2d'), 'LaserObstacleAvoid');
  await rig.rtse('wait', 'RTCLaser0', 'RTCPosition2d0', 'LaserObstacleAvoid0', '--state', 'any', '--timeout', '60');
  shared.studio = await rig.studio();
  shared.page = await open(browser, shared.studio.url);
  await is_ready(shared.page);
  await has_world(shared.page);
  await boxes(shared.page, 3);
  return shared;
}

export const boxes = (page, count) => until(`${count} boxes`, async () => (await page.locator('.diagram .box').count()) === count);
export const edges = (page, count) => until(`${count} connections`, async () => (await page.locator('.diagram .edge').count()) === count);
export const in_state = (page, state, count) => until(`${count} ${state}`, async () => (await page.locator(`.diagram .box.state-${state}`).count()) === count);
export const path_of = (page, instance) => page.evaluate((name) => window.studio.store.system.components.find((c) => c.instance === name)?.path, instance);
export const choose = async (page, instance) => {
  const path = await until(instance, () => path_of(page, instance));
  await page.evaluate((id) => window.studio.select({ kind: 'component', id }), path);
  return path;
};

export async function drag(page, from, to) {
  const at = async (port) => {
    const [instance, name] = port.split(':');
    const box = await page.locator(`[data-port="${await path_of(page, instance)}:${name}"] > path`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const [a, b] = [await at(from), await at(to)];
  await page.mouse.move(...a);
  await page.mouse.down();
  await page.mouse.move((a[0] + b[0]) / 2, a[1] + 20, { steps: 3 });
  await page.mouse.move(...b, { steps: 3 });
  await page.mouse.up();
  await page.locator('dialog[open] button.main').click();
}

// What is in the middle of the world's view, to the right.
export async function pull(page, pixels) {
  const box = await page.locator('.world canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + pixels, y, { steps: 5 });
  await page.mouse.up();
}

export const drives = (rig) => until('the robot drives', async () => (await rig.speed()) > 0.05);
export const stands = (rig) => until('the robot stands', async () => Math.abs(await rig.speed()) < 0.01);
