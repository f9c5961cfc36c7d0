// The socket to rtm-studio: requests and replies, events, poses and images. It waits for a server that is gone and comes back by itself.
import { has_run } from './run_blocks';
import { RunData } from './run_data';
import { fetch_data, token } from './token';

export interface Port { name: string; kind: 'in' | 'out' | 'service'; data_type: string; interfaces?: { instance: string; type: string; provided: boolean }[]; properties?: Record<string, string>; connections?: string[] }
export interface Context { index: number; owned: boolean; kind: string; rate: number | null; running: boolean; state: string; type?: string; properties?: Record<string, string> }
export interface Component {
  path: string; instance: string; type: string; category?: string; vendor?: string; version?: string; description?: string; problem?: string;
  state: State; composite?: boolean; members?: string[]; active_set?: string; in_simulated_time?: boolean; contexts: Context[]; ports: Port[];
}
export interface ConfigValue { name: string; value: string; type?: string; widget?: string; constraint?: string }
export interface ComponentDetail extends Component { properties?: Record<string, string>; sets?: { id: string; active: boolean; values: ConfigValue[] }[] }
export type State = 'Active' | 'Inactive' | 'Error' | 'Created' | 'Unknown';
export interface Connection { id: string; name: string; ports: string[]; absent?: string[]; properties: Record<string, string> }
export interface System { revision: number; problem: string; components: Component[]; connections: Connection[]; managers: { path: string; problem?: string }[] }
export interface Iface { type: string; name: string; model?: string; info?: Record<string, unknown> }
export interface WorldEvent {
  present: boolean; problem: string; is_coming?: boolean; server_id: number; name: string; file?: string; lockstep?: boolean; step?: number; version: number; birth?: string; links: number;
  models: { name: string; static: boolean }[]; ifaces: Iface[];
}
export interface Participant { name: string; pid: number; phase: number; rate: number; ticks: number; missed: number; mean_us: number; max_us: number; active: boolean; late: boolean }
export interface TimeEvent {
  sim_time: number; steps: number; paused: boolean; waiting_for: number; rtf: number; rtf_wanted: number; load: number; models?: number; bodies?: number; contacts?: number;
  parts?: { name: string; calls: number; total_ms: number; max_us: number }[]; participants?: Participant[];
}
export interface Signal { topic: string; kind: 'port' | 'iface' | 'image' | 'state' | 'log'; type: string; model?: string; component?: string }
export interface LogLine { level: string; source: string; time?: number; text: string }
// What is recorded, and all of it that is little: states of components by path, and logs, each with its time [s].
export interface Recording {
  file: string; from: number; to: number; step: number; damage: string; states: Record<string, [number, string][]>; lines: [number, string, string, string][]; lines_left_out: number;
}
// Of a page with a run in it; `at` [s] and `select` (a component or a model): where it opens. `other`: the recording that is compared with.
export interface RunMark { time: number; kind: string; text: string; subject?: string }
export interface RunResult {
  passed?: boolean; why?: string[]; note?: string; seed?: number; hash?: string; command?: string; at?: number; select?: string; left_out?: string[];
  marks?: RunMark[]; other?: string; plot?: { topic: string; member: string } | null;
}
export interface Hello { version: string; read_only: boolean; name_server: string; server_id: number; start?: { simulator: string; components: string }; recording?: Recording; page?: RunResult }
// Of a recorded moment: models that the scene of the beginning does not have, with the triangles of their links, and those that are there no more.
export interface Late { version: number; models: { name: string; links: { name: string; parts: { color: number[]; points: number[] }[] }[] }[]; gone: string[] }
export interface Values { rate?: number; latency?: number; watch: number; t: number[]; v?: unknown[][]; value?: unknown; error?: string }

export interface Poses { version: number; time: number; all: boolean; count: number; view: DataView }

export interface Reply { result: any; command?: string }
export class Refused extends Error {
  constructor(message: string, readonly command?: string) { super(message); }
}

interface Events {
  status: 'connecting' | 'open' | 'lost' | 'forbidden' | 'no token' | 'damaged';
  hello: Hello;
  system: System;
  states: { states: Record<string, State>; rates?: Record<string, [number | null, boolean]> };
  world: WorldEvent;
  time: TimeEvent;
  logs: { lines: LogLine[] };
  signals: { signals: Signal[] };
  values: Values;
  late: Late;
  poses: Poses;
  ghosts: Poses; // of the recording that is compared with
  image: { watch: number; time: number; jpeg: Blob };
}

export class Wire {
  private socket: Pick<WebSocket, 'send' | 'readyState'> | null = null;
  private next_id = 1;
  private open: Map<number, { resolve: (reply: Reply) => void; reject: (error: Error) => void; text: string }> = new Map();
  private queued: string[] = [];
  private listeners: { [op: string]: ((event: any) => void)[] } = {};
  private tries = 0;
  private is_greeted = false; // on this socket
  status: Events['status'] = 'connecting';
  damage = ''; // of the data in this page

  on<K extends keyof Events>(op: K, work: (event: Events[K]) => void): void {
    (this.listeners[op] ??= []).push(work);
  }

  private tell<K extends keyof Events>(op: K, event: Events[K]): void {
    for (const work of this.listeners[op] ?? []) work(event);
  }

  private set(status: Events['status']): void {
    this.status = status;
    this.tell('status', status);
  }

  // A browser lets a page send nothing but subprotocols with a WebSocket: one of them is the token.
  async connect(): Promise<void> {
    if (has_run()) return this.open_run();
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const right = await token;
    if (!right) return this.set('no token');
    const socket = new WebSocket(`${scheme}://${location.host}/ws`, ['rtmsim.studio.v1', `token.${right}`]);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.is_greeted = false;
    socket.onopen = () => {
      this.tries = 0;
      this.set('open');
    };
    socket.onmessage = (message) => this.take(message.data);
    socket.onclose = () => this.lost();
  }

  private async open_run(): Promise<void> {
    this.damage = '';
    this.watch_for_damage();
    try {
      const run = await RunData.open((data) => this.take(data), (why) => {
        this.damage = why;
        this.tell('status', this.status);
      });
      this.socket = run;
      this.set('open');
      run.begin();
    } catch (error) {
      this.fail(error);
    }
  }

  private fail(why: unknown): void {
    this.damage ||= (why instanceof Error ? why.message : String(why)) || 'unknown error';
    this.set('damaged');
  }

  // Data of another shape than a page has may fail anywhere in the viewer.
  private watch_for_damage(): void {
    if (this.is_watched) return;
    this.is_watched = true;
    window.addEventListener('error', (event) => this.fail(event.error ?? event.message));
    window.addEventListener('unhandledrejection', (event) => this.fail(event.reason));
  }
  private is_watched = false;

  private lost(): void {
    for (const { reject } of this.open.values()) reject(new Refused('the connection to rtm-studio was lost'));
    this.open.clear();
    this.queued = [];
    this.socket = null;
    this.set(this.status === 'forbidden' ? 'forbidden' : 'lost');
    this.tries += 1;
    // A server that is there and does not want this page has another token. The answer may come when the connection is there again.
    const say = (status: Events['status']) => { if (this.status !== 'open') this.set(status); };
    fetch_data('access').then(({ status }) => say(status === 401 || status === 403 ? 'forbidden' : 'lost'), () => say('lost'));
    setTimeout(() => this.connect(), Math.min(3000, 250 * this.tries));
  }

  // What is shown is another now, and does not answer what the one before was asked.
  private forget(): void {
    for (const { reject } of this.open.values()) reject(new Refused('what is shown has changed'));
    this.open.clear();
    this.queued = [];
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data !== 'string') return this.take_binary(data);
    const event = JSON.parse(data);
    // What was asked before the first one is answered all the same.
    if (event.op === 'hello') {
      if (this.is_greeted) this.forget();
      this.is_greeted = true;
    }
    if (event.op !== 'reply') return this.tell(event.op, event);
    const waiting = this.open.get(event.id);
    this.open.delete(event.id);
    if (this.queued.length > 0 && this.socket) this.socket.send(this.queued.shift()!);
    if (!waiting) return;
    if (event.error !== undefined) waiting.reject(new Refused(event.error, event.command));
    else waiting.resolve({ result: event.result ?? {}, command: event.command });
  }

  private take_binary(data: ArrayBuffer): void {
    const view = new DataView(data);
    if (view.getUint8(0) === 0x81 || view.getUint8(0) === 0x85) {
      this.tell(view.getUint8(0) === 0x81 ? 'poses' : 'ghosts', {
        all: (view.getUint8(1) & 1) !== 0,
        version: view.getUint32(4, true),
        time: Number(view.getBigUint64(8, true)) * 1e-9,
        count: view.getUint32(16, true),
        view,
      });
    } else if (view.getUint8(0) === 0x83) {
      this.tell('image', { watch: view.getUint32(4, true), time: Number(view.getBigUint64(8, true)) * 1e-9, jpeg: new Blob([data.slice(16)], { type: 'image/jpeg' }) });
    }
  }

  // The server takes 32 at a time; more wait here.
  request(name: string, args: object = {}, dry = false): Promise<Reply> {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Refused('rtm-studio is not connected'));
    const id = this.next_id++;
    const text = JSON.stringify(dry ? { op: 'request', id, name, args, dry: true } : { op: 'request', id, name, args });
    const socket = this.socket;
    return new Promise((resolve, reject) => {
      this.open.set(id, { resolve, reject, text });
      if (this.open.size > 30) this.queued.push(text);
      else socket.send(text);
    });
  }
}
