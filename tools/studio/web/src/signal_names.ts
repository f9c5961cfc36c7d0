// Which signal is that of a port.
import { component, component_of_port, name_of_port, store } from './store';

export function signal_of_port(id: string) {
  const path = component_of_port(id), name = name_of_port(id);
  return store.signals.find((x) => x.kind === 'port' && (x.topic === id || (x.component === path && x.topic.endsWith(`/${name}`)) || x.topic.endsWith(`${component(path)?.instance}/${name}`)));
}
