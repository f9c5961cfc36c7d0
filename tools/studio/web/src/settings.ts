// What is remembered: in the browser for all pages, and in the link for the one who gets it.
import { changed } from './store';

export interface Settings {
  theme: 'auto' | 'light' | 'dark';
  lasers: boolean; sonars: boolean; names: boolean; trails: boolean; collisions: boolean; contacts: boolean; frames: boolean;
  panels: { tree: boolean; world: boolean; system: boolean; inspector: boolean; bottom: boolean };
  layout: { root: unknown }; // a Split of layout.ts, when it is checked
  layouts: { [name: string]: { root: unknown; panels: Settings['panels'] } };
  tab: 'plots' | 'logs' | 'images' | 'step';
  folded: boolean; // equal robots in the diagram
  positions: { [path: string]: [number, number] };
  plots: { series: { topic: string; member: string }[] }[];
}

const usual: Settings = {
  theme: 'auto', lasers: true, sonars: false, names: true, trails: true, collisions: false, contacts: false, frames: false,
  panels: { tree: true, world: true, system: true, inspector: true, bottom: true },
  layout: { root: null }, layouts: {},
  tab: 'plots', folded: false, positions: {}, plots: [],
};

const key = 'rtm-studio';

function stored(): Partial<Settings> {
  try {
    return JSON.parse(localStorage.getItem(key) ?? '{}');
  } catch {
    return {};
  }
}

function merged(...parts: Partial<Settings>[]): Settings {
  const out: any = structuredClone(usual);
  for (const part of parts) {
    for (const [name, value] of Object.entries(part)) {
      if (!(name in out) || typeof value !== typeof out[name]) continue;
      out[name] = value !== null && typeof value === 'object' && !Array.isArray(value) ? { ...out[name], ...value } : value;
    }
  }
  return out;
}

// A link: #v= and JSON in base64 with its own letters.
export function from_link(): { settings?: Partial<Settings>; eye?: any; selection?: any; moment?: number } {
  const match = /(?:^#|&)v=([\w-]+)/.exec(location.hash);
  if (!match) return {};
  try {
    const octets = Uint8Array.from(atob(match[1].replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
    return JSON.parse(new TextDecoder().decode(octets));
  } catch {
    return {};
  }
}

export function to_link(view: object): string {
  const octets = new TextEncoder().encode(JSON.stringify(view));
  return `#v=${btoa(String.fromCharCode(...octets)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

export const linked = from_link();
export const settings: Settings = merged(stored(), linked.settings ?? {});

let timer = 0;
function store_now(): void {
  clearTimeout(timer);
  timer = 0;
  try {
    localStorage.setItem(key, JSON.stringify(settings));
  } catch { /* a browser that keeps nothing */ }
}
export function keep(): void {
  changed('settings');
  clearTimeout(timer);
  timer = window.setTimeout(store_now, 200);
}
addEventListener('pagehide', () => { if (timer) store_now(); }); // what was changed a moment before a reload is kept, too

export function apply_theme(): void {
  const root = document.documentElement;
  if (settings.theme === 'auto') delete root.dataset.theme;
  else root.dataset.theme = settings.theme;
}
