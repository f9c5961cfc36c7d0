// Runs whose pages are opened: an obstacle course, a farm with a camera, a leader with its follower, a run that fails, a hundred robots.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

// Of each: its page and its recording. `robots`: models that move, at least.
export async function write_pages(rig, lib, source, write = () => {}) {
  const worlds = join(source, 'worlds'), systems = join(worlds, 'systems'), avoid = join(systems, 'obstacle_avoidance.xml');
  const hundred = join(rig.work, 'hundred.xml'), never = join(rig.work, 'never.yaml');
  writeFileSync(hundred, readFileSync(avoid, 'utf8').replaceAll('pioneer2dx', 'pioneer_0'));
  writeFileSync(never, '- path_length: {model: pioneer2dx, min: 100}\n');
  const kinds = [['course', avoid, 'obstacle_course.sdf', 1], ['farm', join(systems, 'farm.xml'), 'farm.sdf', 1], ['lead', join(systems, 'leader_follower.xml'), 'leader_follower.sdf', 2],
    ['failed', avoid, 'obstacle_course.sdf', 1, '--expect', never], ['hundred', hundred, 'hundred.sdf', 100]];
  for (const [name, system, world, robots, ...more] of kinds) {
    const [html, file] = ['html', 'mcap'].map((end) => join(rig.work, `${name}.${end}`));
    const run = rig.call('rtse', 'run', system, '-w', join(worlds, world), '-d', '2', '--record', file, '--page', html, '--module-path', lib, '--start-timeout', '120', ...more);
    await (name === 'failed' ? run.catch((error) => { if (error.code !== 1) throw error; }) : run);
    await write({ name, html, file, robots });
  }
}
