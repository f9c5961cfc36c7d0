// A page in front of the stand-in of the server, for flows: what it answers, and a page that is ready.
import { join } from 'node:path';
import { demo_system, hello, Mock, scan, time, world_of } from './mock.mjs';
import { has_world, is_ready, open } from './rig.mjs';

const [bin, source] = process.argv.slice(2);
export const built = process.env.STUDIO_PAGE ?? join(bin, '../share/rtm-sim/studio');
export const glb = join(source, 'tests/studio/course.glb');
export const host = '/localhost:2809/demo.host_cxt';
export const laser = `${host}/RTCLaser0.rtc`, avoid = `${host}/LaserObstacleAvoid0.rtc`;

const options = { problem: '', properties: [{ key: 'dataport.dataflow_type', values: ['push', 'pull'], default: 'push', meaning: 'who fetches' }, { key: 'dataport.subscription_type', values: ['flush', 'new', 'periodic'], default: 'flush', meaning: 'when' }, { key: 'dataport.publisher.push_rate', default: '', meaning: 'Hz' }] };
export const detail = (path) => ({
  ...demo_system().components.find((c) => c.path === path), properties: {},
  sets: [{ id: 'default', active: true, values: [
    { name: 'device_id', value: path === laser ? 'pioneer2dx::laser' : '', type: 'string', widget: 'text' }, { name: 'max_turn', value: '60', type: 'double', widget: 'slider.10', constraint: '0<=x<=180' },
    { name: 'mode', value: 'left', type: 'string', widget: 'radio', constraint: '(left,right)' }, { name: 'days', value: 'mon', type: 'string', widget: 'checkbox', constraint: '(mon,tue,wed)' }, { name: 'count', value: '3', type: 'int', widget: 'spin', constraint: '0<=x<=9' }] }],
});

export function answer(mock) {
  return ({ name, args, dry }) => {
    if (dry) return { command: `rtse con ${args.ports?.map((p) => p.split('/').pop()).join(' ')}` };
    if (name === 'component') return { result: detail(args.path) };
    if (name === 'connection_options') return { result: options };
    if (name === 'watch' && args.topic.includes('laser')) setTimeout(() => mock.say(scan(args.watch)), 20);
    if (name === 'connect') return { result: { id: 'new' }, command: 'rtse con A B' };
    if (name === 'disconnect') return { result: { name: 'range', ports: demo_system().connections[0].ports, properties: {} }, command: 'rtse dis A B' };
    if (name === 'manager') return { result: { components: [{ instance: 'RTCLaser0', type: 'RTCLaser' }], loaded: [], loadable: [{ file: 'RTCCamera.so', type: 'RTCCamera' }], factories: [{ type: 'RTCLaser' }] } };
    if (name === 'create') return { error: 'no component of type Nonsense' };
    if (name === 'save_profile') return { result: { xml: '<rts/>' } };
    if (name === 'models') return { result: { models: [{ name: 'cow' }, { name: 'pioneer2dx' }, { name: 'pioneer2dx_with_camera' }] } };
    if (name === 'spawn') return { result: { name: args.name ?? args.model } };
    if (name === 'check_profile') return { result: { differences: ['connection range: is not there'] } };
    if (name === 'members') return { result: { members: [{ path: 'tm.sec', type: 'number' }, { path: 'data.vx', type: 'number' }], zero: { tm: { sec: 0, nsec: 0 }, data: { vx: 0, vy: 0, va: 0 } } } };
    if (name === 'tree') return { result: { models: [{ name: args.model, links: [{ name: 'chassis', mass: 9 }, { name: 'left_wheel', mass: 1 }], joints: [{ name: 'left', type: 'revolute' }], plugins: [] }] } };
    if (name === 'statistics') return { result: { contexts: [{ path: laser, rate: 100, running: true, cycles: 1000 + 100 * mock.asked.length, missed: 3, mean_ms: 0.2, max_ms: 4, wait_ms: 0 }] } };
    if (name === 'screenshot') return { result: { png: 'iVBORw0KGgo=' }, command: 'simctl screenshot world.png' };
    return {};
  };
}

export const asked = (mock, name) => mock.asked.filter((m) => m.name === name && !m.dry);
export const choose = (page, kind, id) => page.evaluate(([k, i]) => window.studio.select({ kind: k, id: i }), [kind, id]);

export async function set_up(browser) {
  const mock = new Mock({ page: built, glb });
  mock.answer = answer(mock);
  const world = await world_of(glb);
  for (const event of [hello(), demo_system(), world, time(), { op: 'signals', signals: [
    { topic: '/demo/RTCLaser0/range', kind: 'port', type: 'IDL:RTC/RangeData:1.0', component: laser }, { topic: '/sim/laser/pioneer2dx/laser', kind: 'iface', type: 'laser', model: 'pioneer2dx' }] }]) mock.say(event);
  const url = await mock.start();
  const page = await open(browser, url);
  await is_ready(page);
  await has_world(page);
  return { browser, mock, url, page, world };
}
