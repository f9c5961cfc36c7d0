// Fields for parameters of components, as they ask for them.
import { h } from './dom';
import { read_only } from './store';
import type { ConfigValue } from './wire';

// What `__widget__` and `__constraints__` ask for.
export function control(value: ConfigValue, id: string, change: (text: string) => void): HTMLElement {
  const disabled = read_only();
  const send = (field: HTMLInputElement) => {
    field.dataset.known = field.value;
    change(field.value);
  };
  const [kind, step] = (value.widget ?? '').split('.');
  const range = /^\s*([-+\d.e]+)\s*<=?\s*x\s*<=?\s*([-+\d.e]+)\s*$/i.exec(value.constraint ?? '');
  const options = /^\s*\(?(.*?)\)?\s*$/.exec(value.constraint ?? '')?.[1].split(',').map((o) => o.trim()).filter(Boolean) ?? [];
  if ((kind === 'slider' || kind === 'spin') && (range || kind === 'spin')) {
    const number = h('input', { id, type: 'number', value: value.value, 'data-known': value.value, step: kind === 'slider' || !step ? 'any' : step, min: range?.[1], max: range?.[2], disabled, onchange: () => send(number) });
    if (kind === 'spin') return number;
    const [low, high] = [Number(range![1]), Number(range![2])];
    const slider = h('input', { type: 'range', min: low, max: high, step: (high - low) / Math.max(1, Number(step) || 100), value: value.value, 'aria-label': value.name, disabled, 'data-known': value.value, oninput: () => { number.value = slider.value; }, onchange: () => send(slider) });
    return h('span', { class: 'slider' }, slider, number);
  }
  if (kind === 'radio' && options.length > 0) {
    const select_box = h('select', { id, disabled, onpointerdown: () => { select_box.dataset.open = ''; }, onchange: () => { delete select_box.dataset.open; change(select_box.value); } }, [...new Set([value.value, ...options])].map((o) => h('option', { value: o, selected: o === value.value }, o)));
    return select_box;
  }
  if ((kind === 'checkbox' || kind === 'ordered_list') && options.length > 0) {
    const chosen = value.value.split(',').map((v) => v.trim()).filter(Boolean);
    const boxes = options.map((o) => h('input', { type: 'checkbox', checked: chosen.includes(o), disabled, 'aria-label': `${value.name}: ${o}`, onchange: () => change(options.filter((_, i) => boxes[i].checked).join(',')) }));
    return h('span', { class: 'choices', id }, options.map((o, i) => h('label', null, boxes[i], ` ${o}`)));
  }
  const input = h('input', { id, value: value.value, 'data-known': value.value, disabled, onchange: () => send(input) });
  return input;
}

// What stands in it is not what was shown, which `data-known` says; or its list is open.
export function is_edited(element: Element): boolean {
  if (element instanceof HTMLSelectElement) return element.dataset.open !== undefined;
  return element instanceof HTMLInputElement && element.dataset.known !== undefined && element.value !== element.dataset.known;
}
