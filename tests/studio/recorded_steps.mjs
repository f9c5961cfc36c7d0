// A recorded run in the page, whoever has its data: rtm-studio with the recording, or a page that rtse wrote. Each flow gets
// { page, rig, file }, with `file` the recording (MCAP).
import { becomes, check, until } from './rig.mjs';

export const moment = (page) => page.evaluate(() => window.studio.store.time?.sim_time ?? -1);
export const robot = (page) => until('the robot', () => page.evaluate(() => window.studio.world.world?.models.get('pioneer2dx').canonical.position.toArray()));
export const choose = (page, kind, id) => page.evaluate(([k, i]) => window.studio.select({ kind: k, id: i }), [kind, id]);
export const path_of = (page, instance) => until(instance, () => page.evaluate((name) => window.studio.store.system.components.find((c) => c.instance === name)?.path, instance));

// By the slider, as a hand does.
export async function scrub(page, time) {
  await page.locator('.scrub').evaluate((slider, to) => {
    slider.value = String(to);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  }, time);
  await until(`${time} s is shown`, async () => Math.abs((await moment(page)) - time) < 1e-6);
}

// Where the robot was by the file itself.
export async function recorded_place(rig, file, time) {
  const lines = (await rig.call('rtse', 'recording', 'cat', file, '/tf', '--from', String(time - 0.03), '--to', String(time), '--json')).trim().split('\n');
  const last = JSON.parse(lines.at(-1));
  const text = JSON.stringify(last);
  const found = (last.value ?? last.data ?? last.message ?? last.sample).transforms.find((t) => t.child_frame_id === 'pioneer2dx');
  check(found, text.slice(0, 200));
  return [found.transform.translation.x, found.transform.translation.y];
}

export const near = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-3;

export const flows = [
  ['the time line moves the robot to where it was', async ({ page, rig, file }) => {
    for (const time of [11.5, 3, 7.25]) {
      const wanted = await recorded_place(rig, file, time);
      await scrub(page, time);
      await until(`the place at ${time} s`, async () => near(await robot(page), wanted));
    }
    await until('the clock', async () => (await page.locator('.clock').textContent()) === '7.250 s');
  }],
  ['it plays, stops at the end and begins again', async ({ page }) => {
    await scrub(page, 11);
    await page.locator('#speed').fill('4');
    await page.keyboard.press('Enter');
    const before = await robot(page);
    await page.locator('#run').click();
    await until('the end', async () => (await moment(page)) >= 11.999);
    await until('it stops', () => page.evaluate(() => !window.studio.playback.is_playing));
    await until('the robot has moved', async () => !near(await robot(page), before));
    await page.locator('#speed').fill('1');
    await page.keyboard.press('Enter');
    await page.locator('#run').click();
    await until('from the beginning', async () => { const now = await moment(page); return now > 0.2 && now < 11; });
    await page.locator('#run').click();
    const stood = await moment(page);
    await until('it stands', () => page.evaluate(() => !window.studio.playback.is_playing && window.studio.playback.moment === window.studio.store.time?.sim_time));
    check((await moment(page)) < stood + 2, 'it stands');
  }],
  ['steps go on and back, keys too', async ({ page }) => {
    await scrub(page, 5);
    await page.locator('#step').click();
    await until('one on', async () => Math.abs((await moment(page)) - 5.02) < 1e-6);
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press(',');
    await page.keyboard.press(',');
    await until('two back', async () => Math.abs((await moment(page)) - 4.98) < 1e-6);
    await page.keyboard.press('Shift+R');
    await until('the beginning', async () => (await moment(page)) === 0);
  }],
  ['the laser fan is that of the moment', async ({ page }) => {
    await scrub(page, 9);
    const fan = () => page.evaluate(() => { const [one] = window.studio.world.ranges.fans.values(); return Array.from(one.parts[1].geometry.getAttribute('position')?.array.slice(0, 60) ?? []); });
    const late = await until('a fan', async () => { const f = await fan(); return f.length > 0 && f; });
    await scrub(page, 1);
    await until('another one', async () => JSON.stringify(await fan()) !== JSON.stringify(late));
  }],
  ['states are those of the moment, and a band over time', async ({ page }) => {
    const path = await path_of(page, 'RTCLaser0');
    await scrub(page, 6);
    await becomes(() => page.evaluate((p) => window.studio.store.system.components.find((c) => c.path === p).state, path), 'Active', 'state');
    await until('the band is drawn', () => page.evaluate(() => { const band = document.querySelector('canvas.band'); return band.getContext('2d').getImageData(0, 0, band.width, band.height).data.some((v, i) => i % 4 === 3 && v > 0); }));
  }],
  ['parameters are shown and cannot be set', async ({ page }) => {
    await choose(page, 'component', await path_of(page, 'LaserObstacleAvoid0'));
    await until('parameters', async () => (await page.locator('.inspector .grid input').count()) > 5);
    await until('disabled', () => page.locator('.inspector .grid input').first().isDisabled());
    await becomes(() => page.locator('#act-activate').count(), 0, 'buttons');
  }],
  ['a plot shows the whole recording, and a click on it chooses a moment', async ({ page }) => {
    await page.evaluate(() => window.studio.select({ kind: 'signal', id: '/LaserObstacleAvoid0/velocity' }));
    await page.locator('.inspector button[aria-label="Plot data.vx"]').click();
    await until('its line, from the beginning to the end', () => page.evaluate(() => { const { times } = window.studio.bottom.plots.plots[0].lines[0]; return times.length > 100 && times[0] < 0.2 && times.at(-1) > 11.8; }));
    // Again where it is then: the panel may still take its size.
    await until('the middle', async () => {
      const box = await page.locator('.plot .u-over').boundingBox();
      await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
      await page.waitForTimeout(200);
      return Math.abs((await moment(page)) - 6) < 0.1;
    });
  }],
  ['the inspector has the sample of the moment', async ({ page, rig, file }) => {
    await choose(page, 'signal', '/LaserObstacleAvoid0/velocity');
    await scrub(page, 8);
    const lines = (await rig.call('rtse', 'recording', 'cat', file, '/LaserObstacleAvoid0/velocity', '--to', '8', '--json')).trim().split('\n');
    const last = JSON.parse(lines.at(-1));
    const wanted = Number((last.value ?? last.data ?? last.message ?? last.sample).data.vx.toPrecision(6));
    await until(`vx ${wanted}`, async () => Number(await page.locator('.inspector dl.values dt:has-text("data.vx") + dd').textContent()) === wanted);
  }],
];
