// Simulated time seen and led from the page, with the real programs: lockstep_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR. Each flow has a system of its own.
import { join } from 'node:path';
import { is_ready, open, Rig, run, same, until } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);

const choose = async (page, instance) => {
  const path = await until(instance, () => page.evaluate((name) => window.studio.store.system.components.find((c) => c.instance === name)?.path, instance));
  await page.evaluate((id) => window.studio.select({ kind: 'component', id }), path);
};

const flows = [
  ['a component joins simulated time and leaves it', async ({ browser }) => {
    const rig = new Rig(bin, source, lib);
    await rig.claim();
    try {
      await rig.naming();
      await rig.server('worlds/obstacle_course.sdf', '--lockstep');
      rig.host('LaserObstacleAvoid');
      const studio = await rig.studio();
      const page = await open(browser, studio.url);
      await is_ready(page);
      const members = async () => JSON.parse(await rig.simctl('--json', 'participants'));
      await choose(page, 'LaserObstacleAvoid0');
      await page.locator('#act-join_time').click();
      await page.locator('#join-phase').selectOption('7');
      await page.locator('#join-turn').fill('2');
      await page.locator('#join-rate').fill('20');
      if (process.env.STUDIO_PICTURES) await page.screenshot({ path: join(process.env.STUDIO_PICTURES, 'join.png') });
      await page.locator('dialog[open] button.main').click();
      await until('it takes part', async () => { const [one] = await members(); return one?.rate === 20 && one.phase === 7; });
      await page.locator('#act-leave_time').click();
      await until('it has left', async () => (await members()).length === 0);
      await page.locator('#act-join_time').waitFor();
      same(page.problems, [], 'problems');
      await page.context().close();
    } finally {
      await rig.end_all();
    }
  }],
  ['in lock step a step goes to the next tick of a participant', async ({ browser }) => {
    const rig = new Rig(bin, source, lib);
    await rig.claim();
    try {
      await rig.naming();
      await rig.server('worlds/obstacle_course.sdf', '--lockstep', '-u');
      rig.host('-o', 'manager.modules.preload:SimTimeContext.so', '-o', 'exec_cxt.periodic.type:SimTimeContext', 'LaserObstacleAvoid?exec_cxt.periodic.rate=40');
      const one = async () => JSON.parse(await rig.simctl('--json', 'participants'))[0];
      await until('it takes part', async () => (await one())?.active);
      const { name } = await one();
      const studio = await rig.studio();
      const page = await open(browser, studio.url);
      await is_ready(page);
      await until('who takes part', async () => (await page.locator('.waits').textContent()).includes('1 participant'));
      await page.locator('#step-what').selectOption(name);
      const time = async () => JSON.parse(await rig.simctl('--json', 'stats')).sim_time;
      for (let i = 0; i < 3; ++i) {
        const { ticks } = await one(), was = await time();
        const wanted = was === 0 ? 0.001 : Math.floor(was / 0.025 + 1e-6) * 0.025 + 0.025;
        await page.locator('#step').click();
        await until('the tick', async () => (await one()).ticks === ticks + 1 && Math.abs((await time()) - wanted) < 1e-6);
      }
      same(page.problems, [], 'problems');
      await page.context().close();
    } finally {
      await rig.end_all();
    }
  }],
];

run(flows, async (browser) => ({ browser }));
