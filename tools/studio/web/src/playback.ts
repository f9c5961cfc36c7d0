// The moment of a recording that is shown: chosen by hand, or going on by itself. The server is asked for one moment at a time, and then for
// the newest, so that a slow one shows fewer moments and never old ones.
import { changed, on, refresh_details, store, wire } from './store';
import type { Recording, State } from './wire';

const longest_frame = 250; // [ms] a later one plays on more slowly, and skips nothing: frames stop where nobody sees the page
const details_period = 500; // [ms] so often parameters of the selected component are asked for

export const recording = (): Recording | undefined => store.hello?.recording;

export class Playback {
  moment = 0;
  is_playing = false;
  speed = 1;
  problem = '';
  private shown = NaN;
  private file: string | undefined = undefined; // that is shown; empty: a run
  private is_asked = false;
  private asked = 0; // how many; an answer to an earlier one says nothing
  private wants_whole = true; // whatever was shown before
  private last = 0;
  private details_at = 0;
  private details_timer = 0;

  constructor(private readonly jumped: () => void) {
    on('hello', () => this.begin());
    on('scene', () => this.look(true));
    on('selection', () => this.look_at_details());
  }

  private begin(): void {
    const whole = recording();
    if (this.file !== undefined && this.file !== (whole?.file ?? '')) {
      this.moment = whole?.from ?? 0;
      this.is_playing = false;
      this.problem = '';
      this.jumped();
    }
    this.file = whole?.file ?? '';
    if (!whole) return;
    this.is_asked = false;
    this.asked += 1;
    this.moment = Math.min(whole.to, Math.max(whole.from, this.moment));
    store.logs = [];
    this.look(true);
  }

  seek(moment: number): void {
    const whole = recording();
    if (!whole) return;
    const to = Math.min(whole.to, Math.max(whole.from, moment));
    if (to < this.moment || to > this.moment + 2) this.jumped();
    this.moment = to;
    this.look();
  }

  step(way: number): void {
    const step = recording()?.step ?? 0.02;
    this.stop();
    this.seek((Math.round(this.moment / step) + way) * step);
  }

  play_or_stop(): void {
    const whole = recording();
    if (!whole) return;
    if (this.is_playing) return this.stop();
    if (this.moment >= whole.to) this.seek(whole.from);
    this.is_playing = true;
    this.last = performance.now();
    requestAnimationFrame(() => this.go_on());
    this.publish();
  }

  stop(): void {
    this.is_playing = false;
    this.publish();
  }

  private go_on(): void {
    const whole = recording();
    if (!whole || !this.is_playing) return;
    const now = performance.now();
    this.moment = Math.min(whole.to, this.moment + (Math.min(now - this.last, longest_frame) / 1000) * this.speed);
    this.last = now;
    this.look();
    if (this.moment >= whole.to) return this.stop();
    requestAnimationFrame(() => this.go_on());
  }

  private look(is_whole = false): void {
    if (is_whole) this.wants_whole = true;
    if (!recording() || wire.status !== 'open') return;
    if (this.is_asked || (!this.wants_whole && this.shown === this.moment)) return;
    this.is_asked = true;
    const time = this.moment, number = ++this.asked, whole = this.wants_whole;
    this.wants_whole = false;
    const has = (problem: string) => {
      if (number !== this.asked) return;
      if (problem && whole) this.wants_whole = true;
      this.has_shown(time, problem);
    };
    wire.request('look', { time, whole }).then(() => has(''), (error) => has((error as Error).message));
  }

  private has_shown(time: number, problem: string): void {
    this.is_asked = false;
    this.problem = problem;
    this.shown = time;
    this.publish();
    if (!problem || time !== this.moment) this.look();
  }

  private publish(): void {
    const whole = recording();
    if (!whole) return;
    const time = Number.isNaN(this.shown) ? this.moment : this.shown;
    store.time = { sim_time: time, steps: 0, paused: !this.is_playing, waiting_for: 0, rtf: this.speed, rtf_wanted: this.speed, load: 0, parts: [], participants: [] };
    changed('time');
    this.show_states(whole, time);
    const lines = first_after(whole.lines, time);
    if (lines !== store.logs.length) {
      store.logs = whole.lines.slice(0, lines).map(([at, level, source, text]) => ({ time: at, level, source, text }));
      changed('log');
    }
    this.look_at_details();
  }

  private show_states(whole: Recording, time: number): void {
    let is_other = false;
    for (const one of store.system.components) {
      const changes = whole.states[one.path] ?? [];
      const said = changes[first_after(changes, time) - 1]?.[1];
      const state = (said && said !== 'Finalized' ? said : 'Unknown') as State;
      if (changes.length === 0 || state === one.state) continue;
      one.state = state;
      is_other = true;
    }
    if (is_other) changed('states');
  }

  // Parameters are those of the moment.
  private look_at_details(): void {
    const now = store.selection;
    if (!recording() || now?.kind !== 'component') return;
    clearTimeout(this.details_timer);
    const wait = this.details_at + details_period - Date.now();
    this.details_timer = window.setTimeout(() => {
      this.details_at = Date.now();
      refresh_details(now.id);
    }, Math.max(0, wait));
  }
}

// How many are not later than this time; they are in order.
function first_after(list: [number, ...unknown[]][], time: number): number {
  let low = 0, high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle][0] <= time + 1e-9) low = middle + 1;
    else high = middle;
  }
  return low;
}
