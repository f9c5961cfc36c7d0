// Mutated data blocks in a page that stays loaded: the viewer opens its data again after each change, so that thousands are read in minutes.
// mutate_in_page.mjs PAGE_HTML [NUMBER [SEED]]
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { blocks_of, json_of, mutated, random } from './page_mutations.mjs';
import { has_world, launch, open } from './rig.mjs';

const batch = 200;

// Before the page: its frames come when they are asked for, so that no mutation waits for the screen.
function take_frames() {
  let waiting = [];
  const real = requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (work) => waiting.push(work);
  window.give_frame = () => {
    const works = waiting;
    waiting = [];
    for (const work of works) {
      try {
        work(performance.now());
      } catch (error) {
        reportError(error);
      }
    }
  };
  window.has_own_frames = true;
  const go = () => { if (window.has_own_frames) window.give_frame(), real(go); };
  real(go);
}

// In the page. For each [block, text, the whole text]: the data are opened, some times of them are shown, and either there is a message
// or a run. Returns the first that is neither, and how many had a message.
async function read_all(changes) {
  const { playback, store, wire, world } = window.studio;
  const turn = () => new Promise((resolve) => { const { port1, port2 } = new MessageChannel(); port1.onmessage = resolve; port2.postMessage(0); });
  // Nothing is on its way: no request, no world. A turn is one of the event loop, not a time.
  const max_turns = 20000;
  const settle = async () => {
    let still = 0;
    for (let i = 0; i < max_turns && still < 5; ++i) {
      await turn();
      still = wire.open.size === 0 && world.loading < 0 ? still + 1 : 0;
    }
    return still >= 5;
  };
  const open_data = async (needs_world) => {
    if (needs_world) world.world_key = '';
    await wire.connect();
    if (!(await settle())) return false;
    const whole = store.hello?.recording;
    for (const at of [0.9, 0.2]) {
      playback.seek(whole ? whole.from + at * (whole.to - whole.from) : 0);
      if (!(await settle())) return false;
    }
    return true;
  };
  // The texts of a message: of the page as a whole, of the world, of the time line, of a signal that is plotted.
  const message = () => /damaged|cannot be|data of this page|page has no/.exec([...document.querySelectorAll('.link-state,.notice,.waits,.inspector,.plots')].map((e) => e.textContent).join('\n'))?.[0] ?? '';
  let said = 0;
  for (const [number, [id, text, whole]] of changes.entries()) {
    const element = document.getElementById(`run-${id}`);
    const needs_world = id === 'world';
    element.textContent = text;
    const has_settled = await open_data(needs_world);
    window.give_frame();
    if (!has_settled) return { number, why: `nothing more happens, and ${[...wire.open.values()].map((one) => one.text)} waits` };
    if (message()) said += 1;
    else if (wire.status !== 'open' || !world.world) return { number, why: `no message, and the data are ${wire.status}` };
    if (document.querySelector('.page').getBoundingClientRect().height < 100) return { number, why: 'the page is blank' };
    element.textContent = whole;
    if (id !== 'index' && !needs_world) continue;
    const is_whole = await open_data(true);
    window.give_frame();
    if (!is_whole || message() || wire.status !== 'open') return { number, why: '', said };
  }
  return { said };
}

// Throws for a mutation that leaves neither a message nor a run.
export async function mutate_in_page(page, html, number, seed) {
  const text = readFileSync(html, 'utf8'), blocks = blocks_of(text), ids = [...blocks.keys()], json = json_of(blocks), pick = random(seed);
  let said = 0, reloads = 0;
  await page.addInitScript(take_frames);
  const load = async () => {
    await page.goto('about:blank');
    await page.goto(pathToFileURL(html).href);
    await has_world(page);
    await page.evaluate(() => { window.has_own_frames = false; });
  };
  await load();
  for (let done = 0; done < number;) {
    let changes = Array.from({ length: Math.min(batch, number - done) }, () => pick.of(ids)).map((id) => [id, mutated(blocks.get(id), json.get(id), pick), blocks.get(id)]);
    done += changes.length;
    while (changes.length > 0) {
      const result = await page.evaluate(read_all, changes);
      if (result.why) throw new Error(`seed ${seed}, mutation ${done - changes.length + result.number} of block ${changes[result.number][0]}: ${result.why}`);
      said += result.said ?? 0;
      if (result.number === undefined) break;
      changes = changes.slice(result.number + 1); // odd data have left the viewer in a state that whole data do not end: it is loaded anew
      reloads += 1;
      await load();
    }
    if (process.env.STUDIO_LOGS) console.log(`${done} ${said} ${reloads}`);
  }
  await page.context().close();
  return `${number} mutations: ${said} with a message, ${reloads} after which the page was loaded anew`;
}

if (process.argv[1]?.endsWith('mutate_in_page.mjs')) {
  const [html, number = '1000', seed = '1'] = process.argv.slice(2);
  const browser = await launch();
  console.log(await mutate_in_page(await open(browser, undefined, { width: 500, height: 400 }), html, Number(number), Number(seed)));
  await browser.close();
  process.exit(0);
}
