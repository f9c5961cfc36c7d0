// States of components: RTSystemEditor's colours (by class in the style sheet), and a shape for each so that nobody needs colour.
import { s } from './dom';
import type { State } from './wire';

export const state_words: { [state in State]: string } = { Active: 'active', Inactive: 'inactive', Error: 'in error', Created: 'created', Unknown: 'does not answer' };

// In a square of 10 x 10.
const shapes: { [state in State]: string } = {
  Active: 'M2 1L9 5 2 9z',
  Inactive: 'M2 2h6v6H2z',
  Error: 'M5 1L9 9H1z',
  Created: 'M5 1a4 4 0 1 1 0 8 4 4 0 0 1 0-8',
  Unknown: 'M2 2l6 6M8 2l-6 6',
};

export const state_shape = (state: State | undefined): string => shapes[state ?? 'Unknown'] ?? shapes.Unknown;
export const state_class = (state: string | undefined): string => `state-${(state ?? 'Unknown').toLowerCase()}`;

export function state_mark(state: State | undefined): SVGSVGElement {
  return s('svg', { viewBox: '0 0 10 10', class: `mark ${state_class(state)}`, 'aria-hidden': 'true' }, s('path', { d: state_shape(state) }));
}

// A rate [Hz]; null: it is infinite or no number, which JSON has no word for.
export const hertz = (rate: number | null): string => (rate === null ? '– Hz' : `${Number(rate.toPrecision(4))} Hz`);
