// The page draws the world as the simulator does: pixels of the same camera beside `simctl screenshot`. picture_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
// Also: the export holds with Khronos' validator of glTF.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import validator from 'gltf-validator';
import { hello, Mock, time, world_of } from './mock.mjs';
import { check, compared, has_world, open, Rig, run, until } from './rig.mjs';

const [bin, source, lib] = process.argv.slice(2);
const built = process.env.STUDIO_PAGE ?? join(bin, '../share/rtm-sim/studio');
const [width, height] = [640, 480];

// SDFormat's roll, pitch, yaw as x y z w.
function quaternion([roll, pitch, yaw]) {
  const [cr, sr, cp, sp, cy, sy] = [roll, pitch, yaw].flatMap((a) => [Math.cos(a / 2), Math.sin(a / 2)]);
  return [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy];
}

const views = [
  ['worlds/obstacle_course.sdf', 'the arena', [-9, -9, 7, 0, 0.5, 0.785], 1.0, 2],
  ['worlds/obstacle_course.sdf', 'the robot', [-6, -5.4, 1.0, 0, 0.45, 0.5], 0.8, 3],
  ['worlds/farm.sdf', 'the farm', null, 1.0, 4],
];

// The page before anything was clicked.
const opened = ['the farm is opened with the view of simctl screenshot, within 2/255', async ({ browser, rig }) => {
  const server = await rig.server('worlds/farm.sdf', '-u');
  const glb = join(rig.work, 'world.glb'), shot = join(rig.work, 'shot.png');
  await rig.simctl('export', glb);
  await rig.simctl('screenshot', shot, '--size', `${width}x${height}`);
  const mock = new Mock({ page: built, glb });
  for (const event of [hello(), await world_of(glb), time()]) mock.say(event);
  const page = await open(browser, await mock.start());
  await has_world(page);
  const mine = await page.evaluate(async ([w, h]) => {
    const { world, settings } = window.studio;
    Object.assign(settings, { lasers: false, names: false, trails: false });
    world.apply_settings();
    world.element.style.cssText = `position:fixed;left:0;top:0;width:${w}px;height:${h}px;z-index:9`;
    world.resize();
    world.whole();
    world.draw(true);
    return world.canvas.toDataURL('image/png');
  }, [width, height]);
  const found = await compared(page, mine, `data:image/png;base64,${readFileSync(shot).toString('base64')}`);
  console.log(`      mean difference ${found.mean.toFixed(2)}, ${(100 * found.far).toFixed(2)} % of the pixels differ by more than 32`);
  await page.context().close();
  mock.stop();
  await rig.end(server);
  check(found.mean <= 2 && found.far < 0.01, `mean difference ${found.mean}`);
}];

async function set_up(browser) {
  const rig = new Rig(bin, source, lib);
  await rig.claim();
  return { browser, rig };
}

const flows = views.map(([world, name, pose, fov, most]) => [`${name} looks like simctl screenshot, within ${most}/255`, async ({ browser, rig }) => {
  const server = await rig.server(world, '-u');
  const glb = join(rig.work, 'world.glb'), shot = join(rig.work, 'shot.png');
  await rig.simctl('export', glb);
  const octets = readFileSync(glb);
  const report = await validator.validateBytes(new Uint8Array(octets));
  check(report.issues.numErrors === 0, JSON.stringify(report.issues.messages.filter((m) => m.severity === 0).slice(0, 3)));
  const json = JSON.parse(octets.subarray(20, 20 + octets.readUInt32LE(12)).toString());
  const camera = json.scenes[0].extras.camera;
  const place = pose ? { position: pose.slice(0, 3), rotation: quaternion(pose.slice(3)) } : camera ?? { position: [-14, -14, 8], rotation: quaternion([0, 0.35, 0.785]) };
  const angles = pose ? pose.slice(3) : to_angles(place.rotation);
  await rig.simctl('screenshot', shot, '--from', [...place.position, ...angles].join(' '), '--span', String(fov), '--size', `${width}x${height}`);
  const mock = new Mock({ page: built, glb });
  for (const event of [hello(), await world_of(glb), time()]) mock.say(event);
  const page = await open(browser, await mock.start());
  await has_world(page);
  const mine = await page.evaluate(async ([p, r, f, w, h]) => {
    const { world, settings } = window.studio;
    Object.assign(settings, { lasers: false, names: false, trails: false });
    world.apply_settings();
    world.element.style.cssText = `position:fixed;left:0;top:0;width:${w}px;height:${h}px;z-index:9`;
    world.resize();
    world.eye.fix(p, r, f);
    world.draw(true);
    return world.canvas.toDataURL('image/png');
  }, [place.position, place.rotation, fov, width, height]);
  const found = await compared(page, mine, `data:image/png;base64,${readFileSync(shot).toString('base64')}`);
  if (process.env.STUDIO_PICTURES) {
    const { writeFileSync, copyFileSync } = await import('node:fs');
    writeFileSync(join(process.env.STUDIO_PICTURES, `${name.replaceAll(' ', '_')}-page.png`), Buffer.from(mine.split(',')[1], 'base64'));
    copyFileSync(shot, join(process.env.STUDIO_PICTURES, `${name.replaceAll(' ', '_')}-simctl.png`));
  }
  console.log(`      ${name}: mean difference ${found.mean.toFixed(2)}, ${(100 * found.far).toFixed(2)} % of the pixels differ by more than 32`);
  await page.context().close();
  mock.stop();
  await rig.end(server);
  check(found.mean <= most, `mean difference ${found.mean}`);
  void until;
}]);

function to_angles([x, y, z, w]) {
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

run([...flows, opened], set_up, async (shared) => shared?.rig.end_all());
