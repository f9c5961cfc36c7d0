// What the contexts of components have really done, asked for while somebody looks: cycles a second, time of one, missed ones.
import { h } from './dom';
import { recording } from './playback';
import { hertz, state_words } from './states';
import { component, on, wire } from './store';
import { short_path } from './tree';

interface Told { path: string; rate: number; running: boolean; cycles?: number; missed?: number; mean_ms?: number; max_ms?: number; wait_ms?: number }
interface Look { at: number; told: Told }

const state_of = (path: string) => component(path)?.state ?? 'Unknown';

const period = 1000; // [ms]

export class Contexts {
  private rows: { told: Told; done: number | null; mean: number | null; waits: boolean }[] = [];
  private before = new Map<string, Look>();
  private is_asked = false;

  constructor(private readonly show: () => void, private readonly is_seen: () => boolean) {
    setInterval(() => this.ask(), period);
    on('hello', () => {
      this.rows = [];
      this.before.clear();
    });
  }

  private ask(): void {
    if (this.is_asked || !this.is_seen() || recording() || wire.status !== 'open') return;
    this.is_asked = true;
    wire.request('statistics').then(({ result }) => this.take(result?.contexts ?? []), () => this.take([])).finally(() => { this.is_asked = false; });
  }

  // Of the cycles between two looks: means of all time hide what is now.
  private take(all: Told[]): void {
    const at = performance.now();
    const now = new Map(all.map((told): [string, Look] => [told.path, { at, told }]));
    this.rows = all.map((told) => {
      const last = this.before.get(told.path);
      const cycles = told.cycles ?? 0, since = last?.told.cycles ?? 0, count = cycles - since;
      const has_both = last !== undefined && count > 0;
      const mean = (of: (t: Told) => number) => (has_both && cycles < 1e7 ? (of(told) * cycles - of(last.told) * since) / count : of(told));
      const waits = mean((t) => t.wait_ms ?? 0) * (told.rate ?? 0) >= 1000;
      return { told, done: last && told.cycles !== undefined && count >= 0 ? (count * 1000) / (at - last.at) : null, mean: told.cycles ? Math.max(0, mean((t) => t.mean_ms ?? 0)) : null, waits };
    });
    this.before = now;
    this.show();
  }

  table(): HTMLElement | null {
    if (this.rows.length === 0) return null;
    const number = (value: number | null | undefined, digits: number, unit: string) => (value === null || value === undefined ? '–' : `${value.toFixed(digits)}${unit}`);
    return h('table', { class: 'contexts' }, h('caption', null, 'What contexts of components do, by the wall clock'),
      h('thead', null, h('tr', null, ['component', 'asked', 'done', 'mean', 'worst', 'missed', 'state'].map((t) => h('th', { scope: 'col' }, t)))),
      h('tbody', null, this.rows.slice(0, 300).map(({ told, done, mean, waits }) => h('tr', null, h('th', { scope: 'row' }, component(told.path)?.instance ?? short_path(told.path)),
        h('td', null, hertz(told.rate)), h('td', null, number(done, 1, ' Hz')), h('td', null, number(mean, 3, ' ms')), h('td', null, number(told.max_ms, 2, ' ms')), h('td', null, number(told.missed, 0, '')),
        h('td', null, !told.running ? 'stopped' : state_of(told.path) !== 'Active' ? state_words[state_of(told.path)] : waits ? 'waits for data' : '')))));
  }
}
