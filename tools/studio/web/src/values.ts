// Values of signals and constants as text, as a table, and as a polar plot.
import { angle_unit, shown_value } from './angles';
import { h } from './dom';
import { iface_id, store } from './store';

export function table(rows: [string, string][]): HTMLElement | null {
  return rows.length === 0 ? null : h('dl', { class: 'values' }, rows.map(([key, value]) => [h('dt', null, key), h('dd', null, value)]));
}

// Without a minus before nothing.
export const fixed = (value: number, digits: number): string => value.toFixed(digits).replace(/^-(0\.?0*)$/, '$1');

export function flatten(value: unknown, path = '', out: [string, unknown][] = []): [string, unknown][] {
  if (out.length > 400) return out;
  if (Array.isArray(value) && value.length > 8) out.push([path, `${value.length} values`]);
  else if (value !== null && typeof value === 'object') {
    for (const [key, inner] of Object.entries(value)) flatten(inner, Array.isArray(value) ? `${path}[${key}]` : path ? `${path}.${key}` : key, out);
  } else out.push([path, value]);
  return out;
}

export function format(value: unknown): string {
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value)) return String(value);
  return Math.abs(value) < 1e-4 ? value.toExponential(1) : String(Number(value.toPrecision(6)));
}

// With its unit where that is known.
export const measure = (key: string, value: unknown, type: string): string => (typeof value === 'number' ? `${format(shown_value(key, value, type))}${angle_unit(key, type)}` : format(value));

// As angle_unit wants it.
export function kind_of_iface({ type, info }: { type: string; info?: Record<string, unknown> }): string {
  return type === 'joints' ? `joints ${((info?.joints ?? []) as { kind: number }[]).map(({ kind }) => (kind === 1 ? 't' : 's')).join('')}` : type;
}

export function iface_type(topic: string): string {
  const signal = store.signals.find((s) => s.topic === topic && s.kind === 'iface');
  if (signal?.type !== 'joints') return signal?.type ?? '';
  return kind_of_iface(store.world?.ifaces.find((i) => i.type === 'joints' && i.model === signal.model) ?? { type: 'joints' });
}

export function image_iface(topic: string): string | undefined {
  const found = store.world?.ifaces.find((i) => /camera|rgbd|depth/.test(i.type) && topic === `/sim/${i.type}/${i.name.replaceAll('::', '/')}`) ?? store.world?.ifaces.find((i) => topic.includes(`/${i.name.replaceAll('::', '/')}`) && /camera|rgbd|depth/.test(i.type));
  return found && iface_id(found);
}

export function polar(canvas: HTMLCanvasElement, ranges: number[], info: { [key: string]: unknown }): void {
  const draw = canvas.getContext('2d')!;
  const style = getComputedStyle(canvas);
  const { width, height } = canvas;
  const from = (info.angle_min ?? -2.09) as number, to = (info.angle_max ?? 2.09) as number;
  const most = (info.range_max as number | undefined) ?? Math.max(1, ...ranges.filter(Number.isFinite));
  const scale = Math.min(width / 2, height * 0.6) / most, x0 = width / 2, y0 = height * 0.62;
  draw.clearRect(0, 0, width, height);
  draw.strokeStyle = style.getPropertyValue('--line');
  for (const share of [0.5, 1]) {
    draw.beginPath();
    draw.arc(x0, y0, share * most * scale, 0, 2 * Math.PI);
    draw.stroke();
  }
  draw.strokeStyle = style.getPropertyValue('--accent');
  draw.beginPath();
  draw.moveTo(x0, y0);
  ranges.forEach((range, i) => {
    const angle = from + ((to - from) * i) / Math.max(1, ranges.length - 1), r = Math.min(Number(range) || 0, most) * scale;
    draw.lineTo(x0 - r * Math.sin(angle), y0 - r * Math.cos(angle));
  });
  draw.closePath();
  draw.stroke();
}
