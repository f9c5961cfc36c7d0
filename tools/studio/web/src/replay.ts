// Sends the recorded inputs to a component again and compares its outputs.
import { open_dialog } from './dialog';
import { h } from './dom';
import { has_run } from './run_blocks';
import { shell_line } from './shell';
import { act, changed, store } from './store';

// By the studio; a page of a run has no server and shows the command.
export async function replay(instance: string): Promise<void> {
  const text = `Replay ${instance} from the recording`;
  if (has_run()) {
    const file = store.world?.file || store.hello!.recording!.file;
    store.acts.push({ text: `${text} with:`, command: shell_line(['rtse', 'replay', file, '--into', instance, '--compare']) });
    return changed('acts');
  }
  const result = await act(text, 'replay', { component: instance });
  if (result) open_dialog(text, h('pre', { id: 'replayed' }, result.text), 'Close');
}
