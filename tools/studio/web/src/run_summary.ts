// The result of the run above a page that rtse wrote, and the time at which the page opens: that of the failure.
import { button, h } from './dom';
import type { Playback } from './playback';
import { choose, mark_button, mark_lane } from './run_marks';
import { on, store, wire } from './store';
import type { RunMark, RunResult } from './wire';

const result = (): RunResult | undefined => store.hello?.page;

function facts(run: RunResult): [string, string][] {
  const all: [string, unknown][] = [['compared with', run.other], ['seed', run.seed], ['state', run.hash], ['version', store.hello?.version], ['command', run.command]];
  return all.filter(([, value]) => value !== undefined && value !== '').map(([name, value]) => [name, String(value)]);
}

// A line for each reason, with the time at which it happened.
function reasons(run: RunResult, playback: Playback): HTMLElement[] {
  const mark_of = (line: string): RunMark | undefined => run.marks?.find((mark) => mark.text === line);
  return (run.why ?? []).map((line) => {
    const mark = mark_of(line);
    return h('p', { class: 'why' }, mark ? mark_button(playback, mark) : null, mark ? ' ' : null, line);
  });
}

const details = (title: string, rows: unknown[]): HTMLElement | null => (rows.length > 0 ? h('details', null, h('summary', null, title), h('ul', null, rows.map((row) => h('li', null, row as string)))) : null);

export function run_summary(playback: Playback, copy: (text: string) => void, plot: (topic: string, member: string) => void): HTMLElement {
  const element = h('section', { class: 'run-summary', 'aria-label': 'Result of the run', hidden: true });
  on('hello', () => {
    const run = result();
    element.hidden = !run;
    if (!run) return;
    const verdict = run.passed === undefined ? '' : run.passed ? 'passed' : 'failed';
    const marks = run.marks ?? [];
    const parts = [
      h('strong', { class: verdict }, verdict || (run.other ? 'compared' : 'recorded')),
      ...reasons(run, playback), run.note ? h('p', null, run.note) : null,
      h('dl', null, facts(run).map(([name, value]) => [h('dt', null, name), h('dd', null, name === 'command' ? h('code', null, value) : value, name === 'command' ? button('Copy the command that repeats the run', { icon: 'copy', class: 'plain' }, () => copy(value)) : '')])),
      details(`Marks on the time line: ${marks.length}`, marks.map((mark) => [mark_button(playback, mark), ` ${mark.kind}: ${mark.text}`])),
      details(`Left out of this page: ${run.left_out?.length}`, run.left_out ?? [])];
    element.replaceChildren(...parts.filter((part) => part !== null));
    document.querySelector('.mark-lane')?.remove();
    document.querySelector('.line-of-time')?.append(mark_lane(playback, marks));
  });
  // The world comes last: then what failed can be selected. A link of this page names its own time.
  let is_opened = location.hash.length > 1;
  wire.on('world', () => {
    const run = result();
    if (is_opened || !run) return;
    is_opened = true;
    if (typeof run.at === 'number') playback.seek(run.at);
    choose(run.select);
    if (run.plot) plot(run.plot.topic, run.plot.member);
  });
  return element;
}
