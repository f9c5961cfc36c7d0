// What the context menus of wires, ports, components and models offer: the acts of the inspector, where the mouse is.
import { connect_dialog } from './connect_dialog';
import { delete_model, disconnect, disconnect_all } from './inspector';
import { type MenuItem, open_menu } from './menu';
import { inject_dialog } from './rtse_dialogs';
import { component, component_of_port, connection, connections_of, name_of_port, port_of, read_only, select, state_act, store } from './store';
import { signal_of_port } from './signal_names';

type Items = (MenuItem | null | false)[];
export type Plot = (topic: string) => void;

const label = (port: string): string => `${component(component_of_port(port))?.instance ?? component_of_port(port)}:${name_of_port(port)}`;

function values(port: string, plot: Plot): Items {
  const signal = signal_of_port(port);
  return signal ? [{ text: `Show the values of ${name_of_port(port)}`, act: () => select({ kind: 'signal', id: signal.topic }) }, { text: `Plot ${name_of_port(port)}`, act: () => plot(signal.topic) }] : [];
}

export function wire_menu(event: MouseEvent, id: string, plot: Plot): void {
  const one = connection(id);
  if (!one) return;
  select({ kind: 'connection', id });
  const out = one.ports.find((p) => port_of(p)?.kind === 'out');
  open_menu(event, `Connection ${one.name}`, [
    !read_only() && { text: 'Disconnect', key: 'Delete', danger: true, act: () => disconnect(id) },
    ...(out ? values(out, plot) : []),
    ...one.ports.map((p) => ({ text: `Select ${label(p)}`, act: () => select({ kind: 'port', id: p }) })),
  ]);
}

export function port_menu(event: MouseEvent, id: string, plot: Plot): void {
  const port = port_of(id);
  if (!port) return;
  select({ kind: 'port', id });
  const can = !read_only(), all = connections_of(id);
  open_menu(event, `Port ${label(id)}`, [
    can && { text: 'Connect …', key: 'C', act: () => connect_dialog(id) },
    can && port.kind === 'in' && { text: 'Write …', act: () => inject_dialog(id, port.data_type) },
    ...values(id, plot),
    ...(can ? all.map((c) => ({ text: `Disconnect ${c.name || c.ports.filter((p) => p !== id).map(label).join(', ')}`, danger: true, act: () => disconnect(c.id) })) : []),
    can && all.length > 1 && { text: 'Disconnect all', danger: true, act: () => disconnect_all(all) },
  ]);
}

export function component_menu(event: MouseEvent, path: string): void {
  const one = component(path);
  if (!one) return;
  select({ kind: 'component', id: path });
  if (read_only()) return event.preventDefault();
  const all = store.system.connections.filter((c) => c.ports.some((p) => component_of_port(p) === path));
  const does = (text: string, name: string, key: string, from: string): MenuItem => ({ text, key, disabled: one.state !== from, act: () => void state_act(one, text, name) });
  open_menu(event, `Component ${one.instance}`, [
    does('Activate', 'activate', 'A', 'Inactive'), does('Deactivate', 'deactivate', 'D', 'Active'), does('Reset', 'reset', 'E', 'Error'),
    all.length > 0 && { text: 'Disconnect all', danger: true, act: () => disconnect_all(all) },
    { text: 'Exit', danger: true, act: () => void state_act(one, 'Exit', 'exit') },
  ]);
}

export function model_menu(event: MouseEvent, name: string, world: { follow: (model: string) => void; put: (model: string) => void }): void {
  select({ kind: 'model', id: name });
  const is_static = store.world?.models.find((m) => m.name === name)?.static;
  open_menu(event, `Model ${name}`, [
    { text: 'Follow', key: 'F', act: () => world.follow(name) },
    !read_only() && !is_static && { text: 'Put …', act: () => world.put(name) },
    !read_only() && { text: 'Delete', key: 'Delete', danger: true, act: () => delete_model(name) },
  ]);
}
