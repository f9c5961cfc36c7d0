// What happened in a run, on the time line of its page: failures, differences, faults and events.
import { h } from './dom';
import { recording } from './playback';
import type { Playback } from './playback';
import { select, store } from './store';
import type { RunMark } from './wire';

// A component by its instance name, a model by its own or by that of one of its devices.
export function choose(subject: string | undefined): void {
  const component = store.system.components.find((c) => c.instance === subject);
  const model = subject?.split('::')[0];
  if (component) select({ kind: 'component', id: component.path });
  else if (model && store.world?.models.some((m) => m.name === model)) select({ kind: 'model', id: model });
}

function show(playback: Playback, mark: RunMark): void {
  playback.stop();
  playback.seek(mark.time);
  choose(mark.subject);
}

export const mark_button = (playback: Playback, mark: RunMark): HTMLElement =>
  h('button', { type: 'button', class: 'link', title: 'Show this time', onclick: () => show(playback, mark) }, `${mark.time.toFixed(3)} s`);

// Under the band of states; the list in the summary is for keyboards.
export function mark_lane(playback: Playback, marks: RunMark[]): HTMLElement {
  const lane = h('div', { class: 'mark-lane', 'aria-hidden': 'true' });
  const { from, to } = recording()!;
  for (const mark of marks) {
    const sign = h('i', { class: mark.kind, title: `${mark.time.toFixed(3)} s ${mark.kind}: ${mark.text}`, onclick: () => show(playback, mark) });
    sign.style.left = `${(100 * (mark.time - from)) / Math.max(1e-9, to - from)}%`;
    lane.append(sign);
  }
  return lane;
}
