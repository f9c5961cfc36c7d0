// How quick the page of rtm-studio is in the local chromium, before a stand-in of the server: node studio_page.mjs BIN_DIR SOURCE_DIR
// Each number beside its limit. Without a GPU the browser draws in software on the same processors, and so does whatever else runs.
import { join } from 'node:path';
import { demo_system, hello, many_components, Mock, time, world_of } from '../studio/mock.mjs';
import { has_world, launch, open, until } from '../studio/rig.mjs';

const [bin, source] = process.argv.slice(2);
const built = process.env.STUDIO_PAGE ?? join(bin, '../share/rtm-sim/studio');
const glb = join(source, 'tests/studio/course.glb');
const browser = await launch();
const say = (what, value, limit) => console.log(`${what.padEnd(58)} ${value.padStart(12)}   limit ${limit}`);

// First picture: of the second page of a browser, as for somebody who works with it.
async function first_picture() {
  const times = [];
  for (let i = 0; i < 4; ++i) {
    const mock = new Mock({ page: built, glb });
    for (const event of [hello(), demo_system(), await world_of(glb), time()]) mock.say(event);
    const page = await open(browser, await mock.start());
    await has_world(page);
    times.push(await page.evaluate(() => performance.getEntriesByName('first-picture')[0].startTime));
    await page.context().close();
    mock.stop();
  }
  say('first picture after the URL is opened, demo world', `${Math.min(...times.slice(1)).toFixed(0)} ms`, '1000 ms');
}

async function panning() {
  const mock = new Mock({ page: built, glb });
  for (const event of [hello(), many_components(1000), time()]) mock.say(event);
  const page = await open(browser, await mock.start());
  await until('boxes', async () => (await page.locator('.diagram .box').count()) === 1000);
  await page.waitForTimeout(2000);
  const box = await page.locator('.diagram svg').boundingBox();
  await page.mouse.move(box.x + 5, box.y + 5);
  const count = await page.evaluate(() => new Promise((done) => {
    const svg = document.querySelector('.diagram svg'), began = performance.now();
    let frames = 0;
    const to = (type, x) => svg.dispatchEvent(new PointerEvent(type, { bubbles: true, pointerId: 1, clientX: x, clientY: 300, buttons: 1 }));
    svg.setPointerCapture = () => {};
    to('pointerdown', 700);
    const next = () => {
      to('pointermove', 700 + 100 * Math.sin(++frames / 10));
      if (performance.now() - began < 3000) requestAnimationFrame(next);
      else done(frames / 3);
    };
    requestAnimationFrame(next);
  }));
  say('frames a second while 1000 components are panned', count.toFixed(0), '30');
  await page.context().close();
  mock.stop();
}

async function drawing(name, file) {
  const mock = new Mock({ page: built, glb: file });
  for (const event of [hello(), await world_of(file), time()]) mock.say(event);
  const page = await open(browser, await mock.start());
  await has_world(page);
  const cost = await page.evaluate(() => {
    const { world } = window.studio;
    const gl = world.canvas.getContext('webgl2');
    const began = performance.now();
    for (let i = 0; i < 10; ++i) {
      world.draw(true);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return (performance.now() - began) / 10;
  });
  say(`a picture of ${name}, 580 x 500 pixels, shadows anew`, `${cost.toFixed(1)} ms`, '-');
  await page.context().close();
  mock.stop();
}

await first_picture();
await drawing('the demo world', glb);
await panning();
await browser.close();
process.exit(0);
