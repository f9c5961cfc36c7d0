// Conditions that pause the simulation: a value that becomes true of a comparison, or a component that enters the error state. A value is
// compared sample by sample as it comes, so time goes on for a moment before it stops. Of a recording the next time at which it becomes true
// is looked for.
import { angle_unit, shown_value } from './angles';
import { button, h, put } from './dom';
import { open_dialog } from './dialog';
import { iface_type } from './values';
import { recording, type Playback } from './playback';
import { act, changed, component, on, store, wire } from './store';
import { short_path, signal_name } from './tree';
import { watch } from './watches';

type Compare = '<' | '>' | '=' | '≠';
interface Break { text: string; path?: string; stop: () => void; met: boolean }

const holds: { [compare in Compare]: (a: number, b: number) => boolean } = { '<': (a, b) => a < b, '>': (a, b) => a > b, '=': (a, b) => a === b, '≠': (a, b) => a !== b };

export class Breaks {
  readonly element = h('ul', { class: 'breaks', 'aria-label': 'Pause when' });
  private all: Break[] = [];

  constructor(private readonly playback: Playback) {
    on(['states', 'system'], () => this.look_at_states());
    on('hello', () => { if (recording()) this.clear(); });
  }

  has_state(path: string): boolean {
    return this.all.some((one) => one.path === path);
  }

  // Of a component: on, or off again.
  toggle_state(path: string): void {
    const old = this.all.find((one) => one.path === path);
    if (old) return this.remove(old);
    this.add({ text: `${short_path(path)} is in error`, path, stop: () => {}, met: component(path)?.state === 'Error' });
  }

  private look_at_states(): void {
    for (const one of this.all) {
      if (!one.path) continue;
      const is_met = component(one.path)?.state === 'Error';
      if (is_met && !one.met) this.pause(one);
      one.met = is_met;
    }
    this.show();
  }

  // `members`: those that are numbers.
  ask(topic: string, members: string[]): void {
    const signal = store.signals.find((x) => x.topic === topic);
    const member = h('select', { id: 'break-member' }, members.map((m) => h('option', { value: m }, angle_unit(m, iface_type(topic)) ? `${m} [${angle_unit(m, iface_type(topic))}]` : m)));
    const compare = h('select', { id: 'break-compare', 'aria-label': 'Comparison' }, (Object.keys(holds) as Compare[]).map((c) => h('option', null, c)));
    const value = h('input', { id: 'break-value', type: 'number', step: 'any', required: true, class: 'number', 'aria-label': 'Value' });
    const title = recording() ? 'Go to the next time when' : 'Pause when';
    open_dialog(title, h('div', { class: 'grid' }, h('label', { for: 'break-member' }, signal ? signal_name(signal) : topic), member, h('label', { for: 'break-compare' }, 'is'), h('div', { class: 'slider' }, compare, value)), recording() ? 'Go' : 'Add',
      () => (recording() ? this.seek(topic, member.value, compare.value as Compare, Number(value.value)) : this.add_value(topic, member.value, compare.value as Compare, Number(value.value))));
  }

  add_value(topic: string, member: string, compare: Compare, limit: number): void {
    const signal = store.signals.find((x) => x.topic === topic), type = iface_type(topic);
    const one: Break = { text: `${signal ? signal_name(signal) : topic} ${member} ${compare} ${limit}${angle_unit(member, type)}`, stop: () => {}, met: false };
    let is_first = true;
    one.stop = watch({ topic, members: [member], hz: 200 }, ({ v }) => {
      for (const [value] of v ?? []) {
        const is_met = typeof value === 'number' && holds[compare](shown_value(member, value, type) as number, limit);
        if (is_met && !one.met && !is_first) this.pause(one);
        if (is_met !== one.met) {
          one.met = is_met;
          this.show();
        }
        is_first = false;
      }
    });
    this.add(one);
  }

  private async seek(topic: string, member: string, compare: Compare, limit: number): Promise<void> {
    const whole = recording()!, type = iface_type(topic), text = `${member} ${compare} ${limit}`;
    let was: boolean | undefined;
    try {
      for (let from = this.playback.moment; from < whole.to;) {
        const { result } = await wire.request('series', { topic, members: [member], from, to: whole.to, points: 6000 });
        for (const [i, [value]] of result.v.entries()) {
          const is_met = typeof value === 'number' && holds[compare](shown_value(member, value, type) as number, limit);
          if (is_met && was === false) {
            this.playback.seek(result.t[i]);
            return void this.say(`${text} at ${result.t[i].toFixed(3)} s`);
          }
          was = is_met;
        }
        if (!(result.until > from)) break;
        from = result.until;
      }
      this.say(`${text}: never becomes true after ${this.playback.moment.toFixed(3)} s`);
    } catch (error) {
      this.say('', (error as Error).message);
    }
  }

  private say(text: string, error?: string): void {
    store.acts.push({ text, error });
    changed('acts');
  }

  private pause(one: Break): void {
    if (store.time?.paused === false) act(`Pause: ${one.text}`, 'pause', {});
  }

  private add(one: Break): void {
    this.all.push(one);
    this.show();
    changed('details');
  }

  private remove(one: Break): void {
    one.stop();
    this.all.splice(this.all.indexOf(one), 1);
    this.show();
    changed('details');
  }

  private clear(): void {
    for (const one of [...this.all]) this.remove(one);
  }

  private show(): void {
    put(this.element, this.all.map((one) => h('li', { class: one.met ? 'met' : undefined, title: `Pauses when ${one.text}` }, h('span', null, one.text), button(`Do not pause when ${one.text}`, { icon: 'close', class: 'plain small' }, () => this.remove(one)))));
  }
}
