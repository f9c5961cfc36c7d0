// A context menu: at the mouse, or at what has the focus. Arrows choose, Enter acts, Escape and a press elsewhere close it.
import { h } from './dom';

export interface MenuItem { text: string; key?: string; danger?: boolean; disabled?: boolean; act: () => void }

let close_last: (() => void) | null = null;

export function open_menu(event: MouseEvent, name: string, items: (MenuItem | null | false)[]): void {
  event.preventDefault();
  close_last?.();
  const shown = items.filter((item): item is MenuItem => Boolean(item));
  if (shown.length === 0) return;
  const before = document.activeElement as HTMLElement | null;
  const close = () => {
    if (close_last !== close) return;
    close_last = null;
    menu.remove();
    for (const [type, work] of ends) removeEventListener(type, work, true);
    before?.focus({ preventScroll: true });
  };
  const ends: [string, (event: Event) => void][] = [['pointerdown', (e) => { if (!menu.contains(e.target as Node)) close(); }], ['blur', (e) => { if (e.target === window) close(); }], ['resize', close], ['wheel', close]];
  const menu = h('div', { class: 'menu', role: 'menu', 'aria-label': name }, shown.map((item) => h('button', {
    type: 'button', role: 'menuitem', tabindex: -1, class: item.danger ? 'danger' : undefined, disabled: item.disabled, onclick: () => { close(); item.act(); },
  }, h('span', null, item.text), item.key ? h('kbd', null, item.key) : null)));
  menu.addEventListener('keydown', (key) => {
    key.stopPropagation();
    const all = [...menu.querySelectorAll<HTMLButtonElement>('button:not(:disabled)')], at = all.indexOf(document.activeElement as HTMLButtonElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: all.length - 1 }[key.key];
    if (to !== undefined) all[(to + all.length) % all.length]?.focus();
    else if (key.key === 'Escape' || key.key === 'Tab') close();
    else return;
    key.preventDefault();
  });
  menu.addEventListener('contextmenu', (e) => e.preventDefault());
  close_last = close;
  document.body.append(menu);
  const target = (event.target as Element).getBoundingClientRect();
  const [x, y] = event.clientX || event.clientY ? [event.clientX, event.clientY] : [target.left + 8, target.top + 8];
  menu.style.left = `${Math.max(2, Math.min(x, innerWidth - menu.offsetWidth - 2))}px`;
  menu.style.top = `${Math.max(2, Math.min(y, innerHeight - menu.offsetHeight - 2))}px`;
  for (const [type, work] of ends) addEventListener(type, work, true);
  menu.querySelector<HTMLButtonElement>('button:not(:disabled)')?.focus({ preventScroll: true });
}
