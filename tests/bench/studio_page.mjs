// How quick the page of rtm-studio is in the local chromium, before a stand-in of the server: node studio_page.mjs BIN_DIR SOURCE_DIR
// Each number beside its limit. Without a GPU the browser draws in software on the same processors, and so does whatever else runs.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
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

// The page of a run of 60 s while its time line is dragged to and fro, the world 1312 pixels wide. What the page itself does for a picture is
// counted apart from the drawing, which takes other processors where there is a GPU.
async function scrubbing() {
  const work = mkdtempSync(join(tmpdir(), 'studio-')), html = join(work, 'run.html'), lib = join(bin, '../lib');
  execFileSync(join(bin, 'rtse'), ['run', join(source, 'worlds/systems/obstacle_avoidance.xml'), '-w', join(source, 'worlds/obstacle_course.sdf'), '-d', '60', '--page', html, '--module-path', lib], { stdio: 'ignore' });
  const page = await open(browser, undefined, { width: 1320, height: 900, offline: true });
  const firsts = [];
  for (let i = 0; i < 3; ++i) {
    await page.goto('about:blank');
    await page.goto(pathToFileURL(html).href);
    await has_world(page);
    firsts.push(await page.evaluate(() => performance.getEntriesByName('first-picture')[0].startTime));
  }
  say('first picture of the page of a run of 60 s, from a file', `${Math.min(...firsts).toFixed(0)} ms`, '1000 ms');
  for (const key of ['1', '3', '4']) await page.keyboard.press(key); // the world and the time line are left
  await page.waitForTimeout(1500);
  const devtools = await page.context().newCDPSession(page);
  await devtools.send('Performance.enable');
  const spent = async () => Object.fromEntries((await devtools.send('Performance.getMetrics')).metrics.map(({ name, value }) => [name, value]));
  const drag = () => page.evaluate(async () => {
    const { store, world } = window.studio, slider = document.querySelector('.scrub'), times = new Set(), began = performance.now(), frames = world.frames;
    for (let passed = 0; passed < 4000; passed = performance.now() - began) {
      slider.value = String(30 + 27 * Math.sin(passed / 500));
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      await new Promise(requestAnimationFrame);
      times.add(store.time.sim_time);
    }
    return { times: times.size, pictures: (world.frames - frames) / 4, width: world.element.clientWidth };
  });
  await drag();
  const before = await spent(), { times, pictures, width } = await drag(), after = await spent();
  const own = ['ScriptDuration', 'LayoutDuration', 'RecalcStyleDuration'].reduce((sum, name) => sum + after[name] - before[name], 0);
  say(`the page's own work for a time that is shown while it is scrubbed`, `${((1000 * own) / times).toFixed(1)} ms`, '10 ms');
  say(`pictures a second meanwhile, ${width} pixels wide`, pictures.toFixed(0), '30');
  const [all, moving] = await page.evaluate(() => {
    const { world } = window.studio, gl = world.canvas.getContext('webgl2');
    const cost = (draw) => {
      let best = Infinity;
      for (let i = 0; i < 12; ++i) {
        const began = performance.now();
        draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        if (i > 1) best = Math.min(best, performance.now() - began);
      }
      return best;
    };
    const { camera } = world.eye;
    world.set_share(1);
    const all = cost(() => world.renderer.render(world.scene, camera));
    world.backdrop.stands(camera);
    world.backdrop.renew(world.renderer, camera);
    return [all, cost(() => world.backdrop.draw(world.renderer, camera))];
  });
  say('a picture of it with every pixel: all; only what moves', `${all.toFixed(0)}; ${moving.toFixed(0)} ms`, '-');
  await page.context().close();
  rmSync(work, { recursive: true });
}

await first_picture();
await scrubbing();
await drawing('the demo world', glb);
await panning();
await browser.close();
process.exit(0);
