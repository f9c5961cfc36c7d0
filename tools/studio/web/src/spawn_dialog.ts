// A model of the model path, put into the world.
import { in_radians } from './angles';
import { open_dialog } from './dialog';
import { button, h, put } from './dom';
import { act, select, wire } from './store';

// `place`: asks for a place in the world by a press of the mouse.
export function spawn_dialog(place: (what: string, take: (at: { position: number[]; yaw: number }) => void) => void): void {
  const model = h('input', { id: 'spawn-model', list: 'spawn-models', autocomplete: 'off', autofocus: true }), name = h('input', { id: 'spawn-name' }), pose = h('input', { id: 'spawn-pose', value: '0 0 0' });
  const hints = h('datalist', { id: 'spawn-models' });
  const list = h('ul', { class: 'list models', 'aria-label': 'Models of the model path' }, h('li', { class: 'more' }, 'Looking for models …'));
  let names: string[] = [];
  const show = () => {
    const words = names.includes(model.value) ? '' : model.value.trim().toLowerCase();
    const found = names.filter((n) => n.toLowerCase().includes(words));
    put(list, found.length === 0 ? h('li', { class: 'more' }, names.length === 0 ? 'The model path of the simulator has none: see its option --resource-path' : 'No model matches') : found.slice(0, 300).map((n) => h('li', { class: n === model.value ? 'chosen' : undefined }, h('button', { type: 'button', class: 'link', onclick: () => { model.value = n; show(); } }, n))));
  };
  model.addEventListener('input', show);
  wire.request('models').then(({ result }) => {
    names = (result.models ?? []).map((m: { name: string }) => m.name);
    put(hints, names.map((n) => h('option', { value: n })));
    show();
  }, (error) => put(list, h('li', { class: 'problem' }, (error as Error).message)));
  const spawn = (where: number[], yaw: number) => {
    const args: { [key: string]: unknown } = { model: model.value.trim(), pose: [...where, Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)] };
    if (name.value.trim()) args.name = name.value.trim();
    if (args.model) act(`Spawn ${args.model}`, 'spawn', args, (result) => ({ text: `Delete ${result.name}`, name: 'delete_model', args: { model: result.name } })).then((result) => { if (result?.name) select({ kind: 'model', id: result.name }); });
  };
  const by_mouse = button('Choose the place with the mouse in the world', { label: 'Place in the world', id: 'spawn-place' }, () => {
    if (model.value.trim() === '') return void model.focus();
    dialog.close();
    dialog.remove();
    place(model.value.trim(), ({ position, yaw }) => spawn(position, yaw));
  });
  const dialog = open_dialog('Spawn a model', h('div', { class: 'grid' }, h('label', { for: 'spawn-model' }, 'Model'), h('div', null, model, list), h('label', { for: 'spawn-name' }, 'Name (or empty)'), name, h('label', { for: 'spawn-pose' }, 'X Y YAW [m, m, °]'), pose, by_mouse, hints), 'Spawn', () => {
    const [x, y, degrees] = pose.value.split(/[\s,]+/).map(Number);
    spawn([x || 0, y || 0, 0], in_radians(degrees || 0));
  });
}
