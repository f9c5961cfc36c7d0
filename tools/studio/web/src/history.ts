// The last minutes of a live run: where models were, and states of components. In simulated time; forgotten when time goes back. Of a
// recording only how long it is and its states: the server has the rest.
import { recording } from './playback';
import { changed, on, store } from './store';
import type { State } from './wire';
import type { WorldView } from './world';

interface Moment { time: number; places: Float32Array; names: string[] }
export interface Change { time: number; state: State }

const period = 0.1, longest = 300; // [s]
const max_octets = 48e6;

export class History {
  readonly states = new Map<string, Change[]>();
  private moments: Moment[] = [];
  private octets = 0;
  private run = ''; // of which simulator
  private was_recording = false;

  constructor(private readonly world: WorldView) {
    on(['states', 'system'], () => this.note_states());
    on('time', () => this.note_places());
    on('hello', () => {
      const whole = recording();
      if (whole || this.was_recording) {
        this.states.clear();
        this.moments = [];
        this.octets = 0;
      }
      this.was_recording = whole !== undefined;
      if (!whole) return;
      for (const [path, changes] of Object.entries(whole.states)) this.states.set(path, changes.map(([time, state]) => ({ time, state: (state === 'Finalized' ? 'Unknown' : state) as State })));
    });
  }

  get first(): number {
    const whole = recording();
    if (whole) return whole.from;
    return Math.max(this.moments[0]?.time ?? 0, this.last - longest);
  }
  get last(): number {
    return recording()?.to ?? store.time?.sim_time ?? 0;
  }

  private note_states(): void {
    if (recording()) return;
    for (const { path, state } of store.system.components) {
      const changes = this.states.get(path) ?? [];
      if (changes[changes.length - 1]?.state === state) continue;
      changes.push({ time: this.last, state });
      if (changes.length > 500) changes.shift();
      this.states.set(path, changes);
    }
  }

  private note_places(): void {
    const scene = this.world.world;
    if (!scene || recording()) return;
    const newest = this.moments[this.moments.length - 1]?.time ?? -1;
    const run = `${store.world?.server_id}|${store.world?.birth}`;
    if (run !== this.run || this.last < newest) {
      this.moments = [];
      this.octets = 0;
      this.run = run;
      for (const changes of this.states.values()) changes.splice(0, changes.length - 1).forEach(() => {});
      for (const changes of this.states.values()) if (changes[0]) changes[0].time = 0;
    } else if (this.last - newest < period) return;
    const places = this.world.places();
    this.moments.push({ time: this.last, places, names: this.world.link_names() });
    this.octets += places.byteLength;
    while (this.octets > max_octets || (this.moments.length > 1 && this.moments[0].time < this.last - longest)) this.octets -= this.moments.shift()!.places.byteLength;
  }

  // Puts the world and the states as they were, or back to now.
  show(time: number | null): void {
    store.past_states = time === null ? null : this.states_at(time);
    changed('states');
    if (time === null) return this.world.show_past(null);
    let best = this.moments[0];
    for (const moment of this.moments) if (moment.time <= time) best = moment;
    this.world.show_past(best?.places ?? null, best?.names, time);
  }

  private states_at(time: number): Map<string, State> {
    const states = new Map<string, State>();
    for (const [path, changes] of this.states) for (const change of changes) if (change.time <= time || !states.has(path)) states.set(path, change.state);
    return states;
  }
}
