// The results of a campaign: a line for each row, and the recording of one that has failed a click away.
import { parse_csv } from './csv';
import { open_dialog } from './dialog';
import { button, h, put } from './dom';
import { act, wire } from './store';

interface Reply { csv: string; recordings: { row: number; file: string }[] }

const max_rows = 1000; // that are shown
const hidden = new Set(['passed', 'state', 'wall_s']); // `passed` is a mark at the row
const is_number = (text: string): boolean => text !== '' && Number.isFinite(Number(text));
const shown = (text: string): string => (is_number(text) && text.length > 8 ? String(Number(Number(text).toPrecision(6))) : text);

export function campaign_dialog(file: string): void {
  const summary = h('p', { class: 'more', role: 'status' }, 'Reading …');
  const table = h('table', { class: 'campaign' });
  const failed = h('input', { id: 'campaign-failed', type: 'checkbox' });
  const body = h('div', { class: 'campaign-body' }, h('div', { class: 'line' }, summary, h('label', null, failed, ' Failed rows only')), h('div', { class: 'scrolls', tabindex: 0, role: 'region', 'aria-label': 'Rows' }, table));
  const dialog = open_dialog(`Campaign ${file}`, body, 'Close');
  dialog.classList.add('wide');
  wire.request('campaign', { file }).then(({ result }) => show(result as Reply), (error) => put(summary, h('span', { class: 'problem' }, (error as Error).message)));

  const show = ({ csv, recordings }: Reply) => {
    const [head, ...rows] = parse_csv(csv);
    const at = (name: string) => head.indexOf(name);
    const columns = head.map((name, i) => ({ name, i })).filter(({ name }) => !hidden.has(name));
    const recorded = new Map(recordings.map((one) => [String(one.row), one.file]));
    const passed = (row: string[]) => row[at('passed')] === '1';
    const count = rows.filter(passed).length;
    let order: { i: number; up: boolean } | null = null;

    const cell = (row: string[], { name, i }: { name: string; i: number }) => {
      if (name !== 'row') return h('td', { class: is_number(row[i]) ? 'number' : undefined, title: row[i].length > 40 ? row[i] : undefined }, shown(row[i]));
      const mark = passed(row) ? '✓ passed' : '✗ failed', recording = recorded.get(row[i]);
      return h('td', { class: passed(row) ? 'passed' : 'failed' }, `${mark} `, recording
        ? button(`Open the recording of row ${row[i]}`, { label: row[i], class: 'link' }, () => { dialog.close(); dialog.remove(); act(`Open ${recording}`, 'open_recording', { file: recording }); })
        : row[i]);
    };
    const draw = () => {
      const chosen = rows.filter((row) => !failed.checked || !passed(row));
      if (order) {
        const { i, up } = order, sign = up ? 1 : -1;
        chosen.sort((a, b) => sign * (is_number(a[i]) && is_number(b[i]) ? Number(a[i]) - Number(b[i]) : a[i].localeCompare(b[i])));
      }
      put(summary, `${rows.length} rows: ${count} passed, ${rows.length - count} failed${chosen.length > max_rows ? `; the first ${max_rows} are shown` : ''}${recorded.size === 0 && count < rows.length ? '. rtse sweep --record records failed rows' : ''}`);
      put(table, h('thead', null, h('tr', null, columns.map(({ name, i }) => h('th', { scope: 'col', 'aria-sort': order?.i === i ? (order.up ? 'ascending' : 'descending') : undefined },
        button(`Sort by ${name}`, { label: name.split('/').slice(-2).join('/'), class: 'plain' }, () => { order = { i, up: order?.i === i ? !order.up : true }; draw(); }))))),
      h('tbody', null, chosen.slice(0, max_rows).map((row) => h('tr', null, columns.map((column) => cell(row, column))))));
    };
    failed.addEventListener('change', draw);
    draw();
  };
}
