// A stand-in for rtm-studio: serves the page and says what it is told, so that states that real programs reach seldom (a thousand
// components, a hundred robots, refusals) can be looked at. mock.mjs PAGE_DIR WORLD.glb PORT starts it by hand with a small system.
import { createHash } from 'node:crypto';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

export const token = '0123456789abcdef0123456789abcdef';
const types = { html: 'text/html', js: 'text/javascript', css: 'text/css', glb: 'model/gltf-binary' };

function frame(data) {
  const body = Buffer.isBuffer(data) ? data : Buffer.from(data);
  const head = body.length < 126 ? Buffer.from([0, body.length]) : body.length < 65536 ? Buffer.from([0, 126, body.length >> 8, body.length & 255]) : Buffer.alloc(10);
  if (body.length >= 65536) {
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(body.length), 2);
  }
  head[0] = 0x80 | (Buffer.isBuffer(data) ? 2 : 1);
  return Buffer.concat([head, body]);
}

export class Mock {
  constructor({ page, glb, answer }) {
    // `holds`: which requests are answered late, by release(); `holds_file`: the same of paths.
    Object.assign(this, { page, glb, answer, first: [], sockets: new Set(), asked: [], held: [], holds: () => false, holds_file: () => false });
    this.server = createServer((request, reply) => this.serve(request, reply));
    this.server.on('upgrade', (request, socket) => this.welcome(request, socket));
  }

  async start(port = 0) {
    await new Promise((resolve) => this.server.listen(port, '127.0.0.1', resolve));
    return `http://127.0.0.1:${this.server.address().port}/#token=${token}`;
  }

  stop() {
    for (const socket of this.sockets) socket.destroy();
    this.server.close();
  }

  async serve(request, reply) {
    const path = new URL(request.url, 'http://x').pathname;
    if (path === '/world.glb') this.asked.push({ name: path });
    if (this.holds_file(request.method, path)) await new Promise((resolve) => this.held.push({ message: { name: path }, go: resolve }));
    const is_data = path === '/world.glb' || path === '/access';
    if (this.refuses || (is_data && request.headers.authorization !== `Bearer ${token}`)) return void reply.writeHead(403).end();
    if (path === '/access') return void reply.writeHead(204).end();
    try {
      const file = path === '/world.glb' ? this.glb : join(this.page, normalize(path === '/' ? '/index.html' : path));
      let content = await readFile(file);
      // A scene with another version (one digit), as after a model has come or gone.
      if (path === '/world.glb' && this.version) content = Buffer.from(content.toString('latin1').replace(/"version":\d\b/, `"version":${this.version}`), 'latin1');
      reply.writeHead(200, { 'Content-Type': types[file.split('.').pop()] ?? 'application/octet-stream' }).end(content);
    } catch {
      reply.writeHead(404).end('nothing there');
    }
  }

  welcome(request, socket) {
    if (!request.headers['sec-websocket-protocol']?.split(', ').includes(`token.${token}`)) return void socket.end('HTTP/1.1 403 Forbidden\r\n\r\n');
    const key = createHash('sha1').update(request.headers['sec-websocket-key'] + '258EAFA5-E914-47DA-95CA-C5AB0DC85B11').digest('base64');
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\nSec-WebSocket-Protocol: rtmsim.studio.v1\r\n\r\n`);
    this.sockets.add(socket);
    socket.on('close', () => this.sockets.delete(socket));
    socket.on('error', () => {});
    let rest = Buffer.alloc(0);
    socket.on('data', (data) => {
      rest = Buffer.concat([rest, data]);
      for (;;) {
        if (rest.length < 6) return;
        let length = rest[1] & 127, at = 2;
        if (length === 126) [length, at] = [rest.readUInt16BE(2), 4];
        if (rest.length < at + 4 + length) return;
        const mask = rest.subarray(at, at + 4), body = Buffer.from(rest.subarray(at + 4, at + 4 + length));
        body.forEach((byte, i) => { body[i] = byte ^ mask[i % 4]; });
        const op = rest[0] & 15;
        rest = rest.subarray(at + 4 + length);
        if (op === 1) this.hear(socket, JSON.parse(body.toString()));
        if (op === 8) socket.end();
      }
    });
    for (const event of this.first) socket.write(frame(Buffer.isBuffer(event) ? event : JSON.stringify(event)));
  }

  hear(socket, message) {
    this.asked.push(message);
    const reply = { op: 'reply', id: message.id };
    try {
      Object.assign(reply, { result: {}, command: `rtse ${message.name}` }, this.answer?.(message) ?? {});
    } catch (error) {
      reply.error = error.message;
    }
    if (reply.error) delete reply.result;
    const go = () => socket.write(frame(JSON.stringify(reply)));
    if (this.holds(message)) this.held.push({ message, go });
    else go();
  }

  // The answer that waits longest, or the one at `at`.
  release(at = 0) {
    const [{ go }] = this.held.splice(at, 1);
    go();
  }
  release_all() {
    this.holds = this.holds_file = () => false;
    while (this.held.length > 0) this.release();
  }

  // To everybody, and to those who come later.
  say(event, is_kept = true) {
    const op = event.op;
    if (op) this.first = this.first.filter((e) => e.op !== op);
    if (is_kept) this.first.push(event);
    for (const socket of this.sockets) socket.write(frame(Buffer.isBuffer(event) ? event : JSON.stringify(event)));
  }
}

const host = '/localhost:2809/demo.host_cxt';
export const component = (instance, type, state, ports, more = {}) => ({
  path: `${host}/${instance}.rtc`, instance, type, category: 'test', vendor: 'rtm-sim', version: '1.0', description: '', problem: '', state, composite: false, members: [],
  contexts: [{ index: 0, owned: true, kind: 'PERIODIC', rate: 100, running: true, state }], ports: ports.map(([name, kind, data_type]) => ({ name, kind, data_type, interfaces: [] })), ...more,
});

const range = 'IDL:RTC/RangeData:1.0', velocity = 'IDL:RTC/TimedVelocity2D:1.0';
export const demo_system = () => ({
  op: 'system', revision: 1, problem: '', managers: [{ path: `${host}/rtcd.mgr`, problem: '' }],
  components: [
    component('RTCLaser0', 'RTCLaser', 'Active', [['range', 'out', range]]),
    component('LaserObstacleAvoid0', 'LaserObstacleAvoid', 'Active', [['range', 'in', range], ['velocity', 'out', velocity]]),
    component('RTCPosition2d0', 'RTCPosition2d', 'Active', [['velocity', 'in', velocity], ['odometry', 'out', 'IDL:RTC/TimedPose2D:1.0']]),
  ],
  connections: [
    { id: 'a', name: 'range', ports: [`${host}/RTCLaser0.rtc:range`, `${host}/LaserObstacleAvoid0.rtc:range`], properties: { 'dataport.dataflow_type': 'push' } },
    { id: 'b', name: 'velocity', ports: [`${host}/LaserObstacleAvoid0.rtc:velocity`, `${host}/RTCPosition2d0.rtc:velocity`], properties: { 'dataport.dataflow_type': 'push' } },
  ],
});

export function many_components(count) {
  const components = [], connections = [];
  for (let i = 0; i < count; ++i) {
    components.push(component(`Part${i}`, 'Part', ['Active', 'Inactive', 'Active', 'Error'][i % 4], [['in', 'in', range], ['out', 'out', range]]));
    if (i % 10 !== 0) connections.push({ id: `c${i}`, name: `c${i}`, ports: [`${host}/Part${i - 1}.rtc:out`, `${host}/Part${i}.rtc:in`], properties: {} });
  }
  return { op: 'system', revision: 2, problem: '', managers: [], components, connections };
}

// Robots of three components each, that a dispatcher sends orders to; one of them has no laser.
export function fleet(count) {
  const components = [component('Dispatcher', 'Dispatcher', 'Active', [['orders', 'out', range]])], connections = [];
  for (let i = 0; i < count; ++i) {
    if (i !== 2) components.push(component(`Laser_r${i}`, 'RTCLaser', 'Active', [['range', 'out', range]]));
    components.push(component(`Avoid_r${i}`, 'LaserObstacleAvoid', 'Active', [['range', 'in', range], ['orders', 'in', range]]));
    if (i !== 2) connections.push({ id: `l${i}`, name: `l${i}`, ports: [`${host}/Laser_r${i}.rtc:range`, `${host}/Avoid_r${i}.rtc:range`], properties: {} });
    connections.push({ id: `o${i}`, name: `o${i}`, ports: [`${host}/Dispatcher.rtc:orders`, `${host}/Avoid_r${i}.rtc:orders`], properties: {} });
  }
  return { op: 'system', revision: 2, problem: '', managers: [], components, connections };
}

export const hello = (more = {}) => ({ op: 'hello', version: '0.1.0', read_only: false, name_server: 'localhost:2809', server_id: 0, ...more });
export const time = (more = {}) => ({ op: 'time', sim_time: 12.34, steps: 12340, paused: true, waiting_for: 0, rtf: 1, rtf_wanted: 1, load: 0.1, parts: [{ name: 'physics', calls: 100, total_ms: 12, max_us: 300 }], participants: [], ...more });

// What is in a .glb, as the event `world` tells it.
export async function world_of(glb) {
  const octets = await readFile(glb);
  const json = JSON.parse(octets.subarray(20, 20 + octets.readUInt32LE(12)).toString());
  const models = json.nodes.filter((n) => n.extras?.model).map((n) => ({ name: n.name, static: n.extras.static }));
  const ifaces = json.nodes.filter((n) => n.extras?.iface && n.extras.kind === 'ray').map((n) => ({ type: 'laser', name: n.extras.iface, model: n.extras.iface.split('::')[0], info: {} }));
  for (const { model } of [...ifaces]) ifaces.push({ type: 'position2d', name: `${model}::position2d`, model, info: {} });
  return { op: 'world', present: true, problem: '', server_id: 0, name: 'world', file: 'world.sdf', lockstep: false, step: 0.001, version: json.scenes[0].extras.version, links: json.scenes[0].extras.links.length, models, ifaces };
}

// Of links, [index, x, y, z] each, without any turn.
export function poses(version, places, all = false) {
  const frame = Buffer.alloc(24 + 24 * places.length);
  frame[0] = 0x81;
  frame[1] = all ? 1 : 0;
  frame.writeUInt32LE(version, 4);
  frame.writeBigUInt64LE(13000000000n, 8);
  frame.writeUInt32LE(places.length, 16);
  places.forEach(([index, ...place], i) => {
    frame.writeUInt32LE(index, 24 + 24 * i);
    place.forEach((v, k) => frame.writeFloatLE(v, 28 + 24 * i + 4 * k));
    frame.writeInt16LE(32767, 46 + 24 * i);
  });
  return frame;
}

export function scan(watch, beams = 200, t = 1) {
  return { op: 'values', watch, t: [t], value: { ranges: Array.from({ length: beams }, (_, i) => 2 + Math.sin(i / 9) * 0.6 + (i > 90 && i < 120 ? -0.8 : 0)) } };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [page, glb, port] = process.argv.slice(2);
  const mock = new Mock({ page, glb });
  mock.answer = ({ name, args }) => {
    if (name === 'watch') setTimeout(() => mock.say(scan(args.watch)), 50);
    return {};
  };
  for (const event of [hello(), demo_system(), await world_of(glb), time(), { op: 'signals', signals: [{ topic: '/demo/RTCLaser0/range', kind: 'port', type: range, component: `${host}/RTCLaser0.rtc` }] }]) mock.say(event);
  console.log(await mock.start(Number(port)));
}
