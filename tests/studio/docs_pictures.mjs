// Makes the pictures of docs/studio.md and docs/run-page.md anew, with the real programs: docs_pictures.mjs BIN_DIR SOURCE_DIR LIB_DIR [FOLDER]
// Look at each at full size before it is committed. Those of the farm are what picture_flows.mjs writes with STUDIO_PICTURES.
import { writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { has_world, is_ready, launch, open, Rig, until } from './rig.mjs';

const [bin, source, lib, folder] = process.argv.slice(2).map((path) => resolve(path));
const size = { width: 1440, height: 860 };
const robot = 'pioneer2dx';
const rate = ['-o', 'exec_cxt.periodic.rate:100'];

const save = (page, name) => page.screenshot({ path: join(folder ?? join(source, 'docs'), `${name}.png`) });
const time_of = (page) => page.evaluate(() => window.studio.store.time?.sim_time ?? 0);
const path_of = (page, instance) => until(instance, () => page.evaluate((name) => window.studio.store.system.components.find((c) => c.instance === name)?.path, instance));
const choose = (page, kind, id) => page.evaluate(([k, i]) => window.studio.select({ kind: k, id: i }), [kind, id]);
const plot = (page, topic, members) => page.evaluate(([t, all]) => all.forEach((m) => window.studio.bottom.plots.add(t, m)), [topic, members]);
const at = (page, seconds) => until(`${seconds} s`, async () => (await time_of(page)) >= seconds);

async function page_of(browser, rig, boxes, more = {}) {
  const studio = await rig.studio();
  const page = await open(browser, studio.url, { ...size, ...more });
  await is_ready(page);
  await has_world(page);
  await until('boxes', async () => (await page.locator('.diagram .box').count()) === boxes);
  return page;
}

async function with_rig(work) {
  const rig = new Rig(bin, source, lib);
  try {
    await rig.claim();
    await work(rig);
  } finally {
    await rig.end_all();
  }
}

async function wire(rig, number = '') {
  const [laser, avoid, drive] = ['RTCLaser', 'LaserObstacleAvoid', 'RTCPosition2d'].map((name) => `${name}${number || 0}`);
  await rig.rtse('con', `${laser}:range`, `${avoid}:range`, '-n', 'range');
  await rig.rtse('con', `${avoid}:velocity`, `${drive}:velocity`, '-n', 'velocity');
  return [laser, avoid, drive];
}

// Of a demo that drives, and of its laser in the error state.
async function demo(browser, rig) {
  await rig.naming();
  await rig.server('worlds/obstacle_course.sdf');
  rig.host(...rate, rig.device('RTCLaser'), rig.device('RTCPosition2d'), 'LaserObstacleAvoid');
  const page = await page_of(browser, rig, 3);
  await wire(rig);
  await choose(page, 'model', robot);
  await plot(page, `/sim/position2d/${robot}/position2d`, ['velocity[0]', 'velocity[2]']);
  await at(page, 6);
  await page.locator('#activate-all').click();
  await at(page, 29);
  await save(page, 'studio');
  await rig.rtse('deact', 'RTCLaser0');
  await rig.rtse('conf', 'RTCLaser0', 'set', 'device_id', `${robot}::lazer`);
  await choose(page, 'component', await path_of(page, 'RTCLaser0'));
  await page.locator('#act-activate').click();
  await page.locator('#tab-logs').click();
  await page.locator('.log > .level-error', { hasText: 'lazer' }).first().waitFor();
  await at(page, (await time_of(page)) + 5);
  await save(page, 'studio-error');
}

async function hundred(browser, rig) {
  await rig.naming();
  await rig.server('worlds/hundred.sdf', '--rtf', '1');
  const driven = Array.from({ length: 10 }, (_, i) => i);
  const device = (type, i, iface) => `${rig.device(type)}&conf.default.device_id=pioneer_${i}::${iface}`;
  rig.host(...rate, ...driven.flatMap((i) => [device('RTCLaser', i, 'laser'), device('RTCPosition2d', i, 'position2d'), 'LaserObstacleAvoid']));
  const page = await page_of(browser, rig, 30, { scheme: 'dark' });
  for (const i of driven) await wire(rig, String(i));
  await choose(page, 'model', 'pioneer_4');
  await plot(page, '/sim/position2d/pioneer_4/position2d', ['velocity[0]', 'velocity[2]']);
  await page.locator('#activate-all').click();
  await until('all are active', async () => (await page.locator('.diagram .box.state-active').count()) === 30);
  await at(page, (await time_of(page)) + 24);
  await save(page, 'studio-hundred');
}

async function empty(browser, rig) {
  const studio = await rig.studio();
  const page = await open(browser, studio.url, size);
  await page.locator('.world .card').waitFor();
  await page.locator('.diagram .card').waitFor();
  await save(page, 'studio-empty');
}

async function recording(browser, rig) {
  const file = join(rig.work, 'run.mcap');
  await rig.call('rtse', 'run', join(source, 'worlds/systems/obstacle_avoidance.xml'), '-w', join(source, 'worlds/obstacle_course.sdf'), '-d', '20', '--record', file);
  const studio = await rig.studio(file);
  const page = await open(browser, studio.url, size);
  await is_ready(page);
  await has_world(page);
  await choose(page, 'component', await path_of(page, 'LaserObstacleAvoid0'));
  await plot(page, '/LaserObstacleAvoid0/velocity', ['data.vx', 'data.va']);
  await page.evaluate(() => window.studio.playback.seek(15));
  await at(page, 15);
  await until('both lines', async () => (await page.locator('.plot canvas').count()) === 2);
  await page.waitForTimeout(1500); // the last of what the page draws
  await save(page, 'studio-recording');
}

// Of a run that leaves its region.
async function run_page(browser, rig) {
  const html = join(rig.work, 'run.html'), expectations = join(rig.work, 'expect.yaml');
  writeFileSync(expectations, `- stay: {model: ${robot}, region: [-6, -6, -2.5, 6]}\n`);
  await rig.call('rtse', 'run', join(source, 'worlds/systems/obstacle_avoidance.xml'), '-w', join(source, 'worlds/obstacle_course.sdf'), '-d', '30', '--expect', expectations, '--page', html).catch((error) => error.stdout);
  const page = await open(browser, pathToFileURL(html).href, { width: 1100, height: 640 });
  await has_world(page);
  await plot(page, '/LaserObstacleAvoid0/velocity', ['data.vx', 'data.va']);
  await page.evaluate((name) => window.studio.world.follow(name), robot);
  await until('both lines', async () => (await page.locator('.plot canvas').count()) === 2);
  await page.waitForTimeout(1500); // the last of what the page draws
  await save(page, 'run-page');
}

const browser = await launch();
for (const scene of [demo, hundred, empty, recording, run_page]) {
  if (process.env.STUDIO_FLOW && !process.env.STUDIO_FLOW.split('|').includes(scene.name)) continue;
  await with_rig((rig) => scene(browser, rig));
  console.log(`made ${scene.name}`);
}
await browser.close();
