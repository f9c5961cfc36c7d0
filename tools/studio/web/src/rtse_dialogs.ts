// What rtse does to one component or port and needs words for: taking part in simulated time, writing to a port.
import { h, put } from './dom';
import { open_dialog } from './dialog';
import { act, component_of_port, name_of_port, wire } from './store';
import { short_path } from './tree';
import type { Component } from './wire';

const highest_phase = 15;

export function join_dialog(one: Component): void {
  const usual_phases = ['before all others, as sensors', 'clients', 'after them, as actuators'];
  const phase = h('select', { id: 'join-phase', autofocus: true }, Array.from({ length: highest_phase + 1 }, (_, i) => h('option', { value: i, selected: i === 1 }, usual_phases[i] ? `${i}: ${usual_phases[i]}` : i)));
  const turn = h('input', { id: 'join-turn', type: 'number', step: 1, min: 0, max: 9999, value: 0, class: 'number' });
  const usual = one.contexts.find((c) => c.owned)?.rate;
  const rate = h('input', { id: 'join-rate', type: 'number', step: 'any', min: 0.000001, class: 'number', placeholder: usual ? String(usual) : '' });
  const tick = h('input', { id: 'join-tick', type: 'checkbox' });
  const body = h('div', { class: 'grid' }, h('label', { for: 'join-phase' }, 'Phase of a tick'), phase, h('label', { for: 'join-turn', title: 'A reader needs a lower number than its senders' }, 'Call order within the phase'), turn, h('label', { for: 'join-rate' }, 'Ticks a second of simulated time'), rate,
    h('label', { for: 'join-tick', title: 'Only of a component whose own context is ticked from outside' }, 'Tick its own context'), tick);
  open_dialog(`Add ${one.instance} to simulated time`, body, 'Join', () => {
    const args: { [key: string]: unknown } = { path: one.path, phase: Number(phase.value) };
    if (Number(turn.value) > 0) args.turn = Number(turn.value);
    if (rate.value) args.rate = Number(rate.value);
    if (tick.checked) args.tick = true;
    act(`${one.instance} joins simulated time`, 'join_time', args, () => ({ text: `${one.instance} leaves simulated time`, name: 'leave_time', args: { path: one.path } }));
  });
}

// Begins with a value of the port's type in which everything is zero.
export function inject_dialog(port: string, type: string): void {
  const value = h('textarea', { id: 'inject-value', autofocus: true, rows: 8, spellcheck: 'false' });
  const hint = h('p', { class: 'hint' }, 'Loading the type …');
  const label = `${short_path(component_of_port(port))}:${name_of_port(port)}`;
  wire.request('members', { topic: port }).then(({ result }) => {
    if (value.value === '') value.value = JSON.stringify(result?.zero ?? {}, null, 1).replace(/\{\n\s+"sec": 0,\n\s+"nsec": 0\n\s+\}/, '{ "sec": 0, "nsec": 0 }');
    put(hint, 'Values are those of the data type: angles in radians. Members that are left out are zero. They are written once, to this port alone.');
  }, (error) => put(hint, (error as Error).message));
  open_dialog(`Write to ${label}`, h('div', { class: 'inject' }, h('label', { for: 'inject-value' }, type.replace(/^IDL:|:\d+(\.\d+)?$/g, '')), value, hint), 'Write', () => {
    let text = value.value.trim();
    try {
      text = JSON.stringify(JSON.parse(text));
    } catch { /* RTC.TimedLong({time}, 42) */ }
    if (text) act(`Write to ${label}`, 'inject', { port, value: text });
  });
}
