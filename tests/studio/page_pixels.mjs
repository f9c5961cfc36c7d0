// A page draws the world as rtm-studio draws the recording of the same run: pixels at the same time, with the same camera.
import { scrub } from './recorded_steps.mjs';
import { check, compared, has_world, open, same, until } from './rig.mjs';

const [width, height] = [320, 240];
export const small = { width: 640, height: 480 }; // a page that draws little before
const early = 0.1, late = 1.5; // [s]

// Until its data are there, too.
async function show(page, time) {
  await scrub(page, time);
  await until(`the data of ${time} s`, () => page.evaluate((t) => Math.abs(window.studio.playback.shown - t) < 1e-6 && window.studio.wire.open.size === 0, time));
}

const places = (page) => page.evaluate(() => [...window.studio.world.world.models].map(([name, { canonical }]) => [name, canonical.position.toArray()]));

// Where the robot is that has moved most between the two times.
async function moved(page) {
  await show(page, early);
  const before = new Map(await places(page));
  await show(page, late);
  const far = ([name, [x, y]]) => Math.hypot(x - before.get(name)[0], y - before.get(name)[1]);
  const most = (await places(page)).reduce((a, b) => (far(a) > far(b) ? a : b));
  check(far(most) > 0.1, `${most[0]} moves: ${far(most)} m`);
  return most[1];
}

// Images of the whole world and near the place, as URLs.
async function drawn(page, time, place) {
  await show(page, time);
  await until('the scans of this time', () => page.evaluate((t) => [...window.studio.world.ranges.fans.values()].every(({ now }) => now && Math.abs(now.t.at(-1) - t) < 0.11), time));
  return page.evaluate(([w, h, [x, y, z]]) => {
    const { world } = window.studio;
    world.element.style.cssText = `position:fixed;left:0;top:0;width:${w}px;height:${h}px;z-index:9`;
    world.resize();
    world.trails.forget(); // they are of what each page has been through
    const image = () => { world.draw(true); return world.canvas.toDataURL('image/png'); };
    world.whole();
    const whole = image(), eye = world.eye.target.clone();
    world.eye.orbit_from(eye.clone().set(x - 2, y - 2, z + 1.5), eye.set(x, y, z));
    return { whole, near: image(), fans: world.ranges.fans.size };
  }, [width, height, place]);
}

// `page` shows the file that rtse wrote.
export async function looks_like_the_studio({ rig, browser }, page, file) {
  const place = await moved(page), before = await drawn(page, early, place), mine = await drawn(page, late, place);
  const studio = rig.start('rtm-studio', [file, '-p', '0', ...(process.env.STUDIO_PAGE ? ['--page', process.env.STUDIO_PAGE] : [])]);
  const other = await open(browser, await until('rtm-studio', () => /http:\/\/\S+/.exec(studio.log())?.[0]), small);
  await has_world(other);
  const wanted = await drawn(other, late, place);
  same(mine.fans, wanted.fans, 'scans');
  await other.context().close();
  await rig.end(studio);
  const tool = await open(browser, 'about:blank');
  for (const view of ['whole', 'near']) {
    const { mean, far } = await compared(tool, mine[view], wanted[view]);
    console.log(`      ${view}: mean difference ${mean.toFixed(3)}, ${(100 * far).toFixed(2)} % of the pixels differ by more than 32`);
    check(mean <= 2 && far < 0.01, `${view}: mean difference ${mean}`);
  }
  const { far } = await compared(tool, before.near, mine.near);
  check(far > 0.01, `the images of two times differ: ${far}`);
  await tool.context().close();
}
