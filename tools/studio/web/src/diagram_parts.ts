// Texts and lines of the diagram.
import { hertz } from './states';
import type { Component } from './wire';

export const short_type = (type: string): string => type.replace(/^IDL:/, '').replace(/:\d+(\.\d+)?$/, '');

export function rate_text(one: Component): string {
  const context = one.contexts[0];
  if (!context) return '';
  const more = one.contexts.length > 1 ? ` +${one.contexts.length - 1}` : '';
  return `${hertz(context.rate)}${context.running ? '' : ' stopped'}${more}`;
}

// With the members of a composite component.
export function type_text(one: Component): string {
  const members = one.composite ? one.members ?? [] : [];
  const shown = members.slice(0, 3).join(', ') + (members.length > 3 ? ` and ${members.length - 3} more` : '');
  return shown ? `${one.type} of ${shown}` : one.type;
}

export function curve(from: { x: number; y: number; kind: string }, to: { x: number; y: number; kind: string }): string {
  if (from.kind === 'service' || to.kind === 'service') {
    const low = Math.max(from.y, to.y) + 26;
    return `M${from.x} ${from.y}C${from.x} ${low} ${to.x} ${low} ${to.x} ${to.y}`;
  }
  const dx = to.x - from.x;
  if (dx > 20) {
    const reach = Math.min(90, Math.max(24, dx * 0.45));
    return `M${from.x} ${from.y}C${from.x + reach} ${from.y} ${to.x - reach} ${to.y} ${to.x} ${to.y}`;
  }
  const low = Math.max(from.y, to.y) + 70;
  return `M${from.x} ${from.y}c40 0 40 ${low - from.y} 0 ${low - from.y}H${to.x}c-40 0-40 ${to.y - low} 0 ${to.y - low}`;
}
