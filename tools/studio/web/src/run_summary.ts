// The result of the run above a page that `rtse run --page` wrote, and the time at which the page opens: that of the failure.
import { button, h } from './dom';
import type { Playback } from './playback';
import { on, select, store } from './store';
import type { RunResult } from './wire';

const result = (): RunResult | undefined => store.hello?.page;

function facts(run: RunResult): [string, string][] {
  const all: [string, unknown][] = [['seed', run.seed], ['state', run.hash], ['version', store.hello?.version], ['command', run.command]];
  return all.filter(([, value]) => value !== undefined && value !== '').map(([name, value]) => [name, String(value)]);
}

export function run_summary(playback: Playback, copy: (text: string) => void): HTMLElement {
  const element = h('section', { class: 'run-summary', 'aria-label': 'Result of the run', hidden: true });
  let is_opened = false;
  on('hello', () => {
    const run = result();
    element.hidden = !run;
    if (!run) return;
    const verdict = run.passed === undefined ? '' : run.passed ? 'passed' : 'failed';
    element.replaceChildren(
      h('strong', { class: verdict }, verdict || 'recorded'),
      ...(run.why ?? []).map((line) => h('p', { class: 'why' }, line)),
      h('dl', null, facts(run).map(([name, value]) => [h('dt', null, name), h('dd', null, name === 'command' ? h('code', null, value) : value, name === 'command' ? button('Copy the command that repeats the run', { icon: 'copy', class: 'plain' }, () => copy(value)) : '')])),
      ...(run.left_out?.length ? [h('details', null, h('summary', null, `Left out of this page: ${run.left_out.length}`), h('ul', null, run.left_out.map((line) => h('li', null, line))))] : []));
    if (is_opened || location.hash.length > 1) return; // a link of this page names its own time
    is_opened = true;
    if (typeof run.at === 'number') playback.seek(run.at);
    if (run.select) select({ kind: store.system.components.some((c) => c.instance === run.select) ? 'component' : 'model', id: run.select });
  });
  return element;
}
