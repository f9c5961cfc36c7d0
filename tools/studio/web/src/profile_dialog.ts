// An RTSProfile from the disk, and what is to be done with it: what rtse does with one.
import { h, put } from './dom';
import { open_dialog } from './dialog';
import { act } from './store';

const ways: [string, string, object, string][] = [
  ['open_profile', 'Load', { states: false }, 'connections and parameters as saved'],
  ['open_profile', 'Load with states', { states: true }, 'and activate, deactivate and reset as saved'],
  ['start_system', 'Start', {}, 'activate its components'],
  ['stop_system', 'Stop', {}, 'deactivate its components'],
  ['teardown', 'Tear down', {}, 'remove its connections'],
  ['check_profile', 'Compare', {}, 'what runs with what was saved'],
];

export function profile_dialog(file: string, xml: string, place: (positions: { [path: string]: number[] }) => void): void {
  const boxes = ways.map(([, text, , what], i) => h('label', { class: 'way' }, h('input', { type: 'radio', name: 'way', value: i, checked: i === 0, autofocus: i === 0 }), h('strong', null, text), h('span', { class: 'more' }, what)));
  const force = h('input', { type: 'checkbox', id: 'profile-force' });
  const body = h('div', { class: 'ways' }, boxes, h('label', { class: 'way', title: 'Of Load and Load with states' }, force, h('span', null, 'Set also values that the components forbid')));
  open_dialog(`Open ${file}`, body, 'Do it', async () => {
    const [name, text, args] = ways[Number(body.querySelector<HTMLInputElement>('input[name=way]:checked')!.value)];
    const result = await act(`${text} ${file}`, name, { xml, ...args, ...(force.checked && name === 'open_profile' ? { force: true } : {}) });
    if (result?.positions && name === 'open_profile') place(result.positions);
    if (result?.differences) show(file, result.differences);
  });
}

function show(file: string, differences: string[]): void {
  const body = h('div');
  put(body, differences.length === 0 ? h('p', null, 'What runs is what was saved.') : h('ul', { class: 'list differences' }, differences.map((line) => h('li', null, line))));
  open_dialog(`What runs beside ${file}`, body, 'Close');
}
