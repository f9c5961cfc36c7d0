// Recordings in the folder that rtm-studio was started in: one is chosen, or its path typed, and everybody who looks sees it; and back again.
// Results of campaigns there, which lead to recordings of their rows.
import { campaign_dialog } from './campaign_dialog';
import { button, h, put, with_code } from './dom';
import { open_dialog } from './dialog';
import { act, wire } from './store';

interface Found { file: string; size: number; time: number }
interface Reply { folder: string; open: string; may_open: boolean; files: Found[] }

const size_text = (octets: number): string => (octets < 1e6 ? `${Math.max(1, Math.round(octets / 1e3))} kB` : `${(octets / 1e6).toFixed(1)} MB`);

export function recordings_dialog(): void {
  const file = h('input', { id: 'recording-file', autocomplete: 'off', placeholder: 'run.mcap', autofocus: true });
  const list = h('ul', { class: 'list', id: 'recordings' }, h('li', { class: 'more' }, 'Looking …'));
  const campaigns = h('ul', { class: 'list', id: 'campaigns' });
  const body = h('div', { class: 'recordings' }, h('div', { class: 'grid' }, h('label', { for: 'recording-file' }, 'File'), file), list, campaigns);
  const open = (name: string) => {
    if (name.trim()) act(`Open ${name.trim()}`, 'open_recording', { file: name.trim() });
  };
  const dialog = open_dialog('Open a recording', body, 'Open', () => open(file.value));
  const show = ({ folder, open: opened, may_open, files }: Reply) => {
    file.disabled = !may_open;
    put(list,
      h('li', { class: 'more' }, `${files.length === 0 ? 'No recordings' : files.length === 200 ? 'The newest 200 recordings' : files.length === 1 ? 'One recording' : `${files.length} recordings`} in ${folder} and below it${may_open ? '' : '; this studio is read-only and opens none'}`),
      files.length === 0 ? h('li', { class: 'more' }, h('span', null, ...with_code('Make one: `rtse record --all -o run.mcap` of what runs now, or `rtse run SYSTEM.xml --record run.mcap`.'))) : null,
      opened ? h('li', null, button(`Back from ${opened} to what rtm-studio was started for`, { label: 'Back to what was shown at first', id: 'close-recording' }, () => {
        dialog.close();
        act(`Close ${opened}`, 'close_recording', {});
      })) : null,
      files.map((one) => h('li', null,
        may_open && one.file !== opened ? h('button', { type: 'button', class: 'link', onclick: () => { dialog.close(); open(one.file); } }, one.file) : h('span', null, one.file),
        h('span', { class: 'more' }, `${size_text(one.size)}, ${new Date(one.time * 1000).toLocaleString()}${one.file === opened ? ', shown now' : ''}`))));
  };
  const show_campaigns = ({ files }: Reply) => {
    if (files.length > 0) put(campaigns, h('li', { class: 'more' }, 'Results of campaigns'), files.map((one) => h('li', null,
      h('button', { type: 'button', class: 'link', onclick: () => { dialog.close(); dialog.remove(); campaign_dialog(one.file); } }, one.file), h('span', { class: 'more' }, new Date(one.time * 1000).toLocaleString()))));
  };
  wire.request('recordings').then(({ result }) => show(result as Reply), (error) => put(list, h('li', { class: 'problem' }, (error as Error).message)));
  wire.request('campaigns').then(({ result }) => show_campaigns(result as Reply), () => {});
}
