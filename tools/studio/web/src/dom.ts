// Elements without a framework.

type Child = Node | string | number | null | undefined | false | Child[];
type Props = { [key: string]: unknown };

function fill(element: Element, props: Props | null, children: Child[]): void {
  for (const [key, value] of Object.entries(props ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith('on') && typeof value === 'function') element.addEventListener(key.slice(2), value as EventListener);
    else if (key === 'value' && 'value' in element) (element as HTMLInputElement).value = String(value);
    else if (value === true) element.setAttribute(key, '');
    else element.setAttribute(key, String(value));
  }
  append(element, children);
}

function append(parent: Element, children: Child[]): void {
  for (const child of children) {
    if (Array.isArray(child)) append(parent, child);
    else if (child instanceof Node) parent.append(child);
    else if (child !== null && child !== undefined && child !== false) parent.append(String(child));
  }
}

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, props?: Props | null, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, props ?? null, children);
  return element;
}

export function s<K extends keyof SVGElementTagNameMap>(tag: K, props?: Props | null, ...children: Child[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  fill(element, props ?? null, children);
  return element;
}

export function put(parent: Element, ...children: Child[]): void {
  parent.replaceChildren();
  append(parent, children);
}

// Line drawings of 16 x 16.
const icons: { [name: string]: string } = {
  table: 'M2.5 3h11v10h-11zM2.500 6.500h11M2.500 9.800h11M6.500 3v10',
  grip: 'M6 4v.1M6 8v.1M6 12v.1M10 4v.1M10 8v.1M10 12v.1',
  layout: 'M2.5 3h11v10h-11zM6.500 3v10M6.500 8.500h7',
  run: 'M5 3l8 5-8 5z',
  stop: 'M3.5 3.5h9v9h-9z',
  move: 'M8 2v12M2 8h12M6.3 3.7L8 2l1.7 1.7M6.3 12.3L8 14l1.7-1.7M3.7 6.3L2 8l1.7 1.7M12.3 6.3L14 8l-1.7 1.7',
  push: 'M2.5 8h10M9 4.5L12.5 8 9 11.5M2.5 4v8',
  pause: 'M5 3v10M11 3v10',
  step: 'M3 3l7 5-7 5zM13 3v10',
  reset: 'M12.5 8a4.5 4.5 0 1 1-1.5-3.3M11 2v3H8',
  top: 'M2.5 2.5h11v11h-11zM8 5.5v5M5.5 8h5',
  follow: 'M8 2v3M8 11v3M2 8h3M11 8h3M8 5.5a2.5 2.5 0 1 1 0 5 2.5 2.5 0 0 1 0-5',
  whole: 'M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10',
  tree: 'M3 3h10M5 8h8M5 13h8M3 3v10',
  world: 'M8 2l5.5 3v6L8 14l-5.5-3V5zM2.5 5L8 8l5.5-3M8 8v6',
  system: 'M2 3h5v4H2zM9 9h5v4H9zM7 5h4.5v4',
  inspect: 'M3 3h10v10H3zM9.5 3v10',
  plot: 'M2.5 2.5v11h11M4.5 10l3-4 2.5 2 3-4',
  log: 'M3 4h10M3 8h10M3 12h6',
  theme: 'M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11',
  help: 'M5.8 6a2.2 2.2 0 1 1 3.2 2c-.8.4-1 .900-1 1.7M8 12.3v.2',
  close: 'M4 4l8 8M12 4l-8 8',
  copy: 'M5.5 5.5h7v7h-7zM3.5 10.5v-7h7',
  undo: 'M4 6h6a3 3 0 1 1 0 6H6M6.5 3.5L4 6l2.5 2.5',
  plus: 'M8 3v10M3 8h10',
  fold: 'M2.5 2.5h7v5h-7zM4.5 7.5v2h7v-5h-2M6.5 9.5v3h7v-5h-2',
  arrange: 'M2.5 3h3v3h-3zM2.5 10h3v3h-3zM10.5 6.5h3v3h-3zM5.5 4.5h3v7h-3M8.5 8h2',
  broom: 'M9.5 2.5L7 8M4.5 7.5l5.5 2.5M4 8.5L2.5 13h5.5l1.5-2.5M5 13l1-2',
  save: 'M8 2.5v7M5 7l3 3 3-3M3 13.5h10',
  open: 'M8 10.5v-7M5 6l3-3 3 3M3 13.5h10',
  drive: 'M8 2.5l2 2.5H6zM8 13.5l2-2.5H6zM2.5 8L5 6v4zM13.5 8L11 6v4z',
  laser: 'M8 13L3 4M8 13l5-9M8 13V3M3 4a8 8 0 0 1 10 0',
  sonar: 'M3 8l8-4M3 8l8 4M11 4a8 8 0 0 1 0 8',
  names: 'M2.5 8l5-5h6v6l-5 5zM10.5 5.5v.1',
  shapes: 'M2.5 6.5h7v7h-7zM6 6.5v-4h7.5V10h-4',
  frames: 'M4.5 11.5V2.5M3 4l1.5-1.5L6 4M4.5 11.5h9M12 10l1.5 1.5L12 13M4.5 11.5L2 14',
  contact: 'M8 2v6M5.5 5.5L8 8l2.5-2.5M2.5 10.5h11M4 13.5l2-3M8 13.5l2-3M12 13.5l1.5-3',
  link: 'M7 9.5a2.5 2.5 0 0 0 3.5 0l2-2A2.5 2.5 0 0 0 9 4l-1 1M9 6.5a2.5 2.5 0 0 0-3.5 0l-2 2A2.5 2.5 0 0 0 7 12l1-1',
  record: 'M8 4.5a3.5 3.5 0 1 1 0 7 3.5 3.5 0 0 1 0-7',
  trail: 'M2.5 12c3 1 3-4 6-4s2-5 5-4.5',
  camera: 'M2.5 5h2l1-1.5h5l1 1.5h2v8h-11zM8 7a2 2 0 1 1 0 4 2 2 0 0 1 0-4',
};

export function icon(name: string): SVGSVGElement {
  return s('svg', { viewBox: '0 0 16 16', class: 'icon', 'aria-hidden': 'true' }, s('path', { d: icons[name] ?? '' }));
}

interface ButtonOptions {
  icon?: string;
  label?: string;
  name?: string; // for those who do not see the icon beside the label
  key?: string;
  id?: string;
  class?: string;
  disabled?: boolean;
  pressed?: boolean;
}

// A button always has a name: its label, or what it does as tool tip and for screen readers.
export function button(does: string, options: ButtonOptions, act: (event: MouseEvent) => void): HTMLButtonElement {
  const title = options.key ? `${does} (${options.key})` : does;
  const element = h('button', { type: 'button', class: options.class, id: options.id, title, disabled: options.disabled, onclick: act },
    options.icon ? icon(options.icon) : null, options.label ?? null);
  if (options.name ?? !options.label) element.setAttribute('aria-label', options.name ?? does);
  if (options.pressed !== undefined) element.setAttribute('aria-pressed', String(options.pressed));
  return element;
}

export interface FrameWork {
  (): void;
  now: () => void; // what waits for the frame: for keys and clicks, which mean what is known and not what was drawn last
}

// Calls once for any number of requests within a frame.
export function once_a_frame(work: () => void): FrameWork {
  let asked = false;
  const go = () => {
    if (!asked) return;
    asked = false;
    work();
  };
  const ask = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(go);
  };
  return Object.assign(ask, { now: go });
}

// What is under a finger is not made anew: the click would fall on nothing. It is done when the finger is lifted.
let pressed: Node | null = null;
const put_off = new Map<Element, () => void>();

function press(event: Event): void {
  pressed = event.target as Node;
}
function let_go(): void {
  setTimeout(() => { // the click comes first
    pressed = null;
    const works = [...put_off.values()];
    put_off.clear();
    for (const work of works) work();
  });
}
document.addEventListener('pointerdown', press, true);
document.addEventListener('dragstart', press, true);
for (const end of ['pointerup', 'pointercancel', 'dragend']) document.addEventListener(end, let_go, true);
addEventListener('blur', let_go);

export function unless_pressed(element: Element, work: () => void): void {
  if (pressed && element.contains(pressed)) put_off.set(element, work);
  else work();
}

// `words` in backquotes become code.
export function with_code(text: string): (string | HTMLElement)[] {
  return text.split('`').map((part, i) => (i % 2 === 1 ? h('code', null, part) : part));
}
