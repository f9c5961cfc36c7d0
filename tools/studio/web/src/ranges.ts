// What range finders measure, laid over the world: the fan of a laser, a cone for each sonar of a ring. Of a live run the last minutes are
// kept, for the moment of the time line that is shown.
import { BufferAttribute, BufferGeometry, ConeGeometry, DoubleSide, Line, LineBasicMaterial, Mesh, MeshBasicMaterial } from 'three';
import type { Sensor, WorldScene } from './glb';
import { palette } from './palette';
import { settings } from './settings';
import { iface_id, store } from './store';
import type { Values } from './wire';
import { watch } from './watches';

interface Measured { time: number; values: Values; octets: number }
interface Fan { parts: (Mesh | Line)[]; iface: string; stop: () => void; sensors: Sensor[]; measured: Measured[]; now: Values | null; draw: (values: Values) => void }

const max_fans = 24;
const period = 0.1, longest = 300, oldest = 1; // [s] between those that are kept; a moment has none older than `oldest`
const max_octets = 32e6; // of all fans

// Along x, one metre long and one wide at its end: scaled by what is measured.
const cone = new ConeGeometry(1, 1, 24, 1, true).rotateZ(Math.PI / 2).translate(0.5, 0, 0);

export class Ranges {
  readonly fans = new Map<string, Fan>();
  private readonly kept = new Map<string, Measured[]>(); // by fan, also while a scene is read anew
  private moment: number | null = null; // null: now
  private octets = 0;

  constructor(private readonly redraw: () => void) {}

  // Those that the settings ask for, of what the world has.
  show(world: WorldScene): void {
    const wanted = (store.world?.ifaces ?? []).filter((i) => (i.type === 'laser' && settings.lasers) || (i.type === 'sonar' && settings.sonars)).slice(0, max_fans);
    const names = new Set(wanted.map((i) => iface_id(i)));
    for (const name of [...this.fans.keys()]) if (!names.has(name)) this.remove(name);
    wanted.forEach((iface, i) => {
      if (!this.fans.has(iface_id(iface))) this.add(world, iface.name, iface.type, palette[i % palette.length]);
    });
  }

  // Null: now.
  show_at(moment: number | null): void {
    this.moment = moment;
    for (const fan of this.fans.values()) this.show_fan(fan);
    this.redraw();
  }

  private show_fan(fan: Fan): void {
    const values = this.moment === null ? fan.now : fan.measured.findLast((m) => m.time <= this.moment! + 1e-9 && m.time > this.moment! - oldest)?.values;
    for (const part of fan.parts) part.visible = Boolean(values);
    if (values) fan.draw(values);
  }

  private take(fan: Fan, values: Values): void {
    if (!values.value) return;
    fan.now = values;
    if (!store.hello?.recording) this.keep(fan, values);
    if (this.moment === null) this.show_fan(fan);
  }

  private keep(fan: Fan, values: Values): void {
    const time = values.t[values.t.length - 1], newest = fan.measured[fan.measured.length - 1]?.time ?? -Infinity;
    if (time === undefined || (time >= newest && time < newest + period)) return;
    if (time < newest) this.drop(fan.measured, fan.measured.length); // time was set back
    const octets = 8 * ((values.value as { ranges?: unknown[] }).ranges?.length ?? 0) + 200;
    fan.measured.push({ time, values, octets });
    this.octets += octets;
    this.drop(fan.measured, fan.measured.findIndex((m) => m.time >= time - longest));
    while (this.octets > max_octets) {
      const most = [...this.kept.values()].reduce((a, b) => (a.length > b.length ? a : b));
      if (most.length === 0) break;
      this.drop(most, 1);
    }
  }

  private drop(measured: Measured[], count: number): void {
    for (const one of measured.splice(0, Math.max(0, count))) this.octets -= one.octets;
  }

  // Another run.
  forget(): void {
    for (const measured of this.kept.values()) this.drop(measured, measured.length);
  }

  clear(): void {
    for (const name of [...this.fans.keys()]) this.remove(name);
  }

  private add(world: WorldScene, name: string, type: string, color: string): void {
    const sensors = world.sensors.filter((s) => s.iface === name);
    if (sensors.length === 0 || (type === 'laser' && sensors.length > 1)) return;
    const topic = store.signals.find((s) => s.kind === 'iface' && s.type.includes(type) && s.topic.endsWith('/' + name.replaceAll('::', '/')))?.topic ?? `/sim/${type}/${name.replaceAll('::', '/')}`;
    const fill = new MeshBasicMaterial({ color, transparent: true, opacity: type === 'sonar' ? 0.1 : 0.16, side: DoubleSide, forceSinglePass: true, depthWrite: false });
    const fan: Fan = { parts: [], iface: name, sensors, stop: () => {}, measured: this.kept.get(`${type}:${name}`) ?? [], now: null, draw: (values) => (type === 'sonar' ? this.ring(fan, values) : this.scan(fan, values)) };
    if (type === 'sonar') fan.parts = sensors.map(() => new Mesh(cone, fill));
    else fan.parts = [new Mesh(new BufferGeometry(), fill), new Line(new BufferGeometry(), new LineBasicMaterial({ color, transparent: true, opacity: 0.85 }))];
    fan.parts.forEach((part, i) => {
      part.frustumCulled = false;
      part.userData.overlay = true;
      part.renderOrder = 5;
      part.visible = type === 'laser';
      sensors[type === 'sonar' ? i : 0].node.add(part);
    });
    this.fans.set(`${type}:${name}`, fan);
    this.kept.set(`${type}:${name}`, fan.measured);
    fan.stop = watch({ topic, hz: 15 }, (values) => this.take(fan, values));
  }

  private ring(fan: Fan, values: Values): void {
    const ranges = (values.value as { ranges?: number[] } | undefined)?.ranges ?? [];
    fan.parts.forEach((part, i) => {
      const { range_max: most = 5, radius = 0.5 } = fan.sensors[i] as unknown as { range_max?: number; radius?: number };
      const range = Math.min(ranges[i] ?? 0, most);
      part.visible = range > 0.01;
      part.scale.set(range, (radius / most) * range, (radius / most) * range);
    });
    this.redraw();
  }

  private scan(fan: Fan, values: Values): void {
    const sample = values.value as any;
    const ranges: number[] | undefined = sample?.ranges;
    if (!ranges?.length) return;
    const info = (store.world?.ifaces.find((i) => i.type === 'laser' && i.name === fan.iface)?.info ?? {}) as any;
    const sensor = fan.sensors[0];
    const from = sample.angle_min ?? info.min_angle ?? sensor.min_angle ?? -Math.PI / 2;
    const to = sample.angle_max ?? info.max_angle ?? sensor.max_angle ?? Math.PI / 2;
    const most = sample.range_max ?? info.max_range ?? sensor.range_max ?? 30;
    const beams = info.layers > 1 ? Math.floor(ranges.length / info.layers) : ranges.length;
    const points = new Float32Array((beams + 1) * 3);
    for (let i = 0; i < beams; ++i) {
      const angle = from + ((to - from) * i) / Math.max(1, beams - 1);
      const raw = ranges[i];
      const range = typeof raw === 'number' && Number.isFinite(raw) && raw > 0 ? Math.min(raw, most as number) : most as number;
      points[3 * i + 3] = range * Math.cos(angle);
      points[3 * i + 4] = range * Math.sin(angle);
    }
    const [area, edge] = fan.parts;
    const place = area.geometry;
    if (place.getAttribute('position')?.count !== beams + 1) {
      const index = new Uint16Array((beams - 1) * 3);
      for (let i = 0; i + 1 < beams; ++i) index.set([0, i + 1, i + 2], 3 * i);
      place.setIndex(new BufferAttribute(index, 1));
    }
    place.setAttribute('position', new BufferAttribute(points, 3));
    edge.geometry.setAttribute('position', new BufferAttribute(points.slice(3), 3));
    this.redraw();
  }

  private remove(name: string): void {
    const fan = this.fans.get(name);
    if (!fan) return;
    fan.stop();
    for (const part of fan.parts) {
      part.removeFromParent();
      if (part.geometry !== cone) part.geometry.dispose();
    }
    this.fans.delete(name);
  }
}
