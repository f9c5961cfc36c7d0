// The data of a run inside the page itself: a page that `rtse run --page` wrote. It answers the requests of a recording (see the protocol of
// rtm-studio) in place of the server. Parts hold up to ten seconds each and are unpacked when they are needed.
import { from_base64, json_of } from './run_blocks';
import type { Hello, Signal, System, WorldEvent } from './wire';

interface Index { hello: Hello; system: System; signals: { signals: Signal[] }; world: WorldEvent; parts: [number, number][] }
interface Samples { t: number[]; v: unknown[] }
interface Moving { poses: [number, string][]; samples: [string, number, unknown][] }
interface Packed extends Moving { late: [number, object][]; images?: Record<string, [number, string][]>; other?: Moving }
interface Part extends Packed { values: Map<string, Samples>; other_values: Map<string, Samples> }
interface Watch { topic: string; members?: string[]; is_image: boolean; shown: string }
type Timed = [number, ...unknown[]];

const kept_parts = 6;
// The number of entries that are not later than this time.
function count_until(times: (i: number) => number, length: number, time: number): number {
  let low = 0, high = length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times(middle) <= time + 1e-9) low = middle + 1;
    else high = middle;
  }
  return low;
}

function by_topic(all: Moving['samples']): Map<string, Samples> {
  const values = new Map<string, Samples>();
  for (const [topic, time, value] of all) {
    if (!values.has(topic)) values.set(topic, { t: [], v: [] });
    const samples = values.get(topic)!;
    samples.t.push(time);
    samples.v.push(value);
  }
  return values;
}

const to_part = (packed: Packed): Part => ({ ...packed, values: by_topic(packed.samples), other_values: by_topic(packed.other?.samples ?? []) });

// The frame of the recording that is compared with.
function ghost(frame: Uint8Array<ArrayBuffer>): ArrayBuffer {
  frame[0] = 0x85;
  return frame.buffer;
}

const newest = <T extends Timed>(list: T[], time: number): T | undefined => list[count_until((i) => list[i][0], list.length, time) - 1];

// "data.vx", "ranges[3]".
function member_at(value: any, path: string): unknown {
  let at = value;
  for (const [, name, index] of path.matchAll(/([^.[\]]+)|\[(\d+)\]/g)) {
    if (at === null || typeof at !== 'object') return null;
    at = index === undefined ? (Array.isArray(at) ? undefined : at[name]) : at[Number(index)];
  }
  return at ?? null;
}

export class RunData {
  readonly readyState = WebSocket.OPEN;
  private readonly watches = new Map<number, Watch>();
  private readonly parts = new Map<number, Promise<Part>>();
  private parameters: Promise<Record<string, [number, object][]>> | null = null;
  private work: Promise<void> = Promise.resolve();
  private time: number;
  private shown_part = -1;
  private shown_poses = 0; // of the part
  private shown_ghosts = 0;
  private shown_late: object | null = null;

  private constructor(private readonly index: Index, private readonly take: (data: string | ArrayBuffer) => void, private readonly damaged: (why: string) => void) {
    this.time = index.hello.recording!.from;
  }

  // Throws if the index cannot be read. `damaged` is called for each other block that cannot be read.
  static async open(take: (data: string | ArrayBuffer) => void, damaged: (why: string) => void): Promise<RunData> {
    const index = await json_of('index');
    if (!index?.hello?.recording || !Array.isArray(index.parts) || !Array.isArray(index.system?.components)) throw new Error('its index is incomplete');
    return new RunData(index, take, damaged);
  }

  begin(): void {
    const { hello, system, signals, world } = this.index;
    for (const event of [hello, system, signals, world]) this.take(JSON.stringify(event));
  }

  // Requests are answered one after the other.
  send(text: string): void {
    const { id, name, args } = JSON.parse(text);
    this.work = this.work.then(async () => {
      try {
        const result = await this.answer(name, args);
        this.take(JSON.stringify({ op: 'reply', id, result }));
      } catch (error) {
        this.take(JSON.stringify({ op: 'reply', id, error: `the data of this page: ${(error as Error).message}` }));
      }
    });
  }

  private async answer(name: string, args: any): Promise<object> {
    if (name === 'look') return this.look(args.time, args.whole === true);
    if (name === 'series') return this.series(args);
    if (name === 'component') return this.component(args.path);
    if (name === 'unwatch') return this.watches.delete(args.watch), {};
    if (name === 'watch') return this.watch(args.watch, { topic: args.topic, members: args.members, is_image: false, shown: '' });
    if (name === 'watch_image') return this.watch(args.watch, { topic: this.image_topic(args.iface), is_image: true, shown: '' });
    throw new Error(`"${name}" needs a running system`);
  }

  private number_at(time: number): number {
    const { parts } = this.index;
    return Math.max(0, count_until((i) => parts[i][0], parts.length, time) - 1);
  }

  private part(number: number): Promise<Part> {
    const there = this.parts.get(number);
    if (there) return there;
    const part = json_of(String(number)).then(to_part);
    part.catch((error) => this.damaged(`part ${number}: ${error.message}`));
    this.parts.set(number, part);
    for (const old of this.parts.keys()) {
      if (this.parts.size <= kept_parts) break;
      if (old !== number) this.parts.delete(old);
    }
    return part;
  }

  private async look(time: number, is_whole: boolean): Promise<object> {
    const number = this.number_at(time);
    const part = await this.part(number);
    const goes_on = !is_whole && number === this.shown_part && time >= this.time;
    const poses = count_until((i) => part.poses[i][0], part.poses.length, time);
    const late = newest(part.late, time)?.[1] ?? null;
    if (late && (is_whole || JSON.stringify(late) !== JSON.stringify(this.shown_late))) this.take(JSON.stringify(late));
    for (let i = goes_on ? this.shown_poses : 0; i < poses; ++i) this.take(from_base64(part.poses[i][1]).buffer);
    const others = part.other?.poses ?? [], ghosts = count_until((i) => others[i][0], others.length, time);
    for (let i = goes_on ? this.shown_ghosts : 0; i < ghosts; ++i) this.take(ghost(from_base64(others[i][1])));
    [this.time, this.shown_part, this.shown_poses, this.shown_ghosts, this.shown_late] = [time, number, poses, ghosts, late];
    for (const [id, watch] of this.watches) this.show(id, watch, part, is_whole);
    return {};
  }

  private async watch(id: number, watch: Watch): Promise<object> {
    this.watches.set(id, watch);
    this.show(id, watch, await this.part(this.number_at(this.time)), true);
    return {};
  }

  private show(id: number, watch: Watch, part: Part, is_whole: boolean): void {
    const event = (more: object) => this.take(JSON.stringify({ op: 'values', watch: id, ...more }));
    const signal = this.index.signals.signals.some((s) => s.topic === watch.topic);
    const none = () => event({ t: [], error: signal ? 'the page has no sample of it up to this time' : 'it was not recorded' });
    const once = (key: string, work: () => void) => {
      if (key === watch.shown && !is_whole) return;
      watch.shown = key;
      work();
    };
    if (watch.is_image) {
      const image = newest(part.images?.[watch.topic] ?? [], this.time);
      return once(String(image?.[0]), () => (image ? this.show_image(id, image) : none()));
    }
    const samples = part.values.get(watch.topic);
    const at = samples ? count_until((i) => samples.t[i], samples.t.length, this.time) - 1 : -1;
    once(samples && at >= 0 ? String(samples.t[at]) : 'none', () => {
      if (!samples || at < 0) return none();
      const t = [samples.t[at]], value = samples.v[at];
      event(watch.members ? { t, v: [watch.members.map((one) => member_at(value, one))] } : { t, value });
    });
  }

  private show_image(id: number, [time, jpeg]: [number, string]): void {
    const data = from_base64(jpeg);
    const frame = new Uint8Array(16 + data.length);
    const view = new DataView(frame.buffer);
    view.setUint8(0, 0x83);
    view.setUint32(4, id, true);
    view.setBigUint64(8, BigInt(Math.round(Math.max(0, time) * 1e9)), true);
    frame.set(data, 16);
    this.take(frame.buffer);
  }

  // "camera:NAME", "depth:NAME", or the name of either.
  private image_topic(iface: string): string {
    const [, type, name] = /^(?:(camera|depth):(?!:))?(.*)$/s.exec(iface)!;
    const topics = (type ? [type] : ['camera', 'depth']).map((one) => `/sim/${one}/${name.replaceAll('::', '/')}`);
    return topics.find((topic) => this.index.signals.signals.some((s) => s.topic === topic)) ?? topics[0];
  }

  private async component(path: string): Promise<object> {
    if (!this.parameters) {
      this.parameters = json_of('parameters');
      this.parameters.catch((error) => this.damaged(`parameters: ${error.message}`));
    }
    const changes = (await this.parameters)[path];
    if (!changes?.length) throw new Error(`component "${path}" is not in the recording`);
    return newest(changes, this.time)?.[1] ?? changes[0][1];
  }

  // `other`: of the recording that is compared with.
  private async series({ topic, members, from = -Infinity, to = Infinity, points = 4000, other = false }: { topic: string; members: string[]; from?: number; to?: number; points?: number; other?: boolean }): Promise<object> {
    const t: number[] = [], v: unknown[][] = [];
    for (const [number, [begin, end]] of this.index.parts.entries()) {
      if (end < from || begin > to) continue;
      const part = await this.part(number), samples = (other ? part.other_values : part.values).get(topic);
      samples?.t.forEach((time, i) => {
        if (time < from || time > to || (t.length > 0 && time <= t[t.length - 1])) return; // the first repeats the last of the part before
        t.push(time);
        v.push(members.map((one) => member_at(samples.v[i], one)));
      });
    }
    const keep = (i: number) => t.length <= points || Math.floor((i * points) / t.length) !== Math.floor(((i - 1) * points) / t.length);
    return { t: t.filter((_, i) => keep(i)), v: v.filter((_, i) => keep(i)), until: Math.min(to, this.index.hello.recording!.to), left_out: Math.max(0, t.length - points) };
  }
}
