// Two ports, the properties that are valid for this pair, and the command that would do the same.
import { h, put } from './dom';
import { open_dialog } from './dialog';
import { fits } from './diagram';
import { short_type } from './diagram_parts';
import { act, component_of_port, name_of_port, port_of, store, wire } from './store';

interface Option { key: string; values?: string[]; default?: string; meaning?: string }

const label = (port: string) => `${component_of_port(port).split('/').pop()!.replace(/\.rtc$/, '')}:${name_of_port(port)}`;

function partners(port: string): string[] {
  const out: string[] = [];
  for (const one of store.system.components) for (const { name } of one.ports) if (fits(port, `${one.path}:${name}`)) out.push(`${one.path}:${name}`);
  return out;
}

export function connect_dialog(from: string, to?: string): void {
  const others = to ? [to] : partners(from);
  const body = h('div', { class: 'connect' });
  const problem = h('p', { class: 'problem', role: 'alert' });
  const command = h('code', { class: 'command' });
  const choice = h('select', { id: 'connect-to', autofocus: true }, others.map((p) => h('option', { value: p }, label(p))));
  const name = h('input', { id: 'connect-name', value: '' }), id = h('input', { id: 'connect-id', placeholder: 'a new one' });
  // A connection may have more than two ends.
  const further = h('select', { id: 'connect-further', multiple: true, size: 4 });
  const ports = () => [from, choice.value, ...[...further.selectedOptions].map((o) => o.value)];
  const fields = h('div', { class: 'fields' });
  const values = (): { [key: string]: string } => {
    const out: { [key: string]: string } = {};
    for (const field of fields.querySelectorAll<HTMLInputElement | HTMLSelectElement>('[data-key]')) {
      if (field.value !== field.dataset.default && field.value !== '') out[field.dataset.key!] = field.value;
    }
    return out;
  };
  const args = () => ({ ports: ports(), name: name.value, ...(id.value.trim() ? { id: id.value.trim() } : {}), properties: values() });
  // Answers to earlier questions say nothing any more.
  let commands = 0, choices = 0;
  const show_command = async () => {
    const number = ++commands;
    let text = '';
    try {
      text = (await wire.request('connect', args(), true)).command ?? '';
    } catch (error) {
      text = (error as { command?: string }).command ?? '';
    }
    if (number === commands) command.textContent = text;
  };
  const field = (option: Option, i: number) => {
    const id = `connect-p${i}`;
    const usual = option.default ?? '';
    const input = option.values?.length
      ? h('select', { id, 'data-key': option.key, 'data-default': usual }, [...new Set([usual, ...option.values])].map((v) => h('option', { value: v }, v || '(as the ports say)')))
      : h('input', { id, 'data-key': option.key, 'data-default': usual, value: usual });
    input.addEventListener('change', show_command);
    const key = option.key.replace(/^dataport\./, '').replace(/[._]/g, '$&\u200b'); // a long one is broken there
    return [h('label', { for: id, title: option.meaning }, key), input];
  };
  const refresh = async () => {
    const number = ++choices;
    name.value = `${name_of_port(from)}_${name_of_port(choice.value || from)}`;
    problem.textContent = '';
    put(fields, h('p', { class: 'hint' }, 'Loading the properties …'));
    try {
      const { result } = await wire.request('connection_options', { ports: ports() });
      if (number !== choices) return;
      problem.textContent = result.problem ?? '';
      const options: Option[] = result.properties ?? [];
      const main = options.filter((o) => usual_keys.includes(o.key)), rest = options.filter((o) => !usual_keys.includes(o.key));
      put(fields, h('div', { class: 'grid' }, main.map(field)),
        rest.length > 0 ? h('details', null, h('summary', null, `${rest.length} more properties`), h('div', { class: 'grid' }, rest.map((o, i) => field(o, i + main.length)))) : null);
    } catch (error) {
      if (number !== choices) return;
      put(fields);
      problem.textContent = (error as Error).message;
    }
    show_command();
  };
  const type = port_of(from)?.data_type ?? '';
  put(body,
    h('div', { class: 'grid' }, h('span', null, 'From'), h('strong', null, label(from)), h('label', { for: 'connect-to' }, 'To'), choice, h('span', null, 'Type'), h('span', null, short_type(type) || 'service'),
      h('label', { for: 'connect-name' }, 'Name'), name),
    fields, h('details', { class: 'ends' }, h('summary', null, 'Id and further ends'), h('div', { class: 'grid' }, h('label', { for: 'connect-id' }, 'Id'), id, h('label', { for: 'connect-further' }, 'And also to'), further)), problem, command);
  const offer_further = () => put(further, partners(from).filter((p) => p !== choice.value).map((p) => h('option', { value: p }, label(p))));
  offer_further();
  choice.addEventListener('change', () => { offer_further(); refresh(); });
  further.addEventListener('change', refresh);
  for (const field_ of [name, id]) field_.addEventListener('change', show_command);
  if (others.length === 0) problem.textContent = `No other port takes ${short_type(type) || 'this service'}: start a component that has one.`;
  else refresh();
  open_dialog('Connect', body, 'Connect', () => {
    if (others.length === 0) return;
    const all = ports().map(label).join(' and ');
    act(`Connect ${all}`, 'connect', args(), (result) => ({ text: `Disconnect ${all}`, name: 'disconnect', args: { port: from, id: result.id } }));
  });
}

const usual_keys = ['dataport.interface_type', 'dataport.dataflow_type', 'dataport.subscription_type', 'dataport.publisher.push_policy', 'dataport.publisher.push_rate', 'dataport.publisher.skip_count'];
