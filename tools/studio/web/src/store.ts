// What the page knows and shows. Parts change it and hear of changes; nobody else keeps a copy.
import { Wire } from './wire';
import type { Component, ComponentDetail, Connection, Hello, Late, LogLine, Signal, State, System, TimeEvent, WorldEvent } from './wire';

export type Kind = 'model' | 'component' | 'port' | 'connection' | 'signal' | 'manager' | 'iface';
export interface Selection { kind: Kind; id: string }

export type Topic = 'status' | 'system' | 'states' | 'world' | 'time' | 'signals' | 'selection' | 'details' | 'log' | 'acts' | 'settings' | 'hello' | 'plots' | 'scene';

export interface Act {
  text: string;
  command?: string;
  error?: string;
  group?: object; // acts of one group are undone together
  undo?: { text: string; name: string; args: object };
}

export const wire = new Wire();

export const store = {
  hello: null as Hello | null,
  system: { revision: 0, problem: '', components: [], connections: [], managers: [] } as System,
  has_system: false,
  world: null as WorldEvent | null,
  late: null as Late | null,
  time: null as TimeEvent | null,
  signals: [] as Signal[],
  details: new Map<string, ComponentDetail>(),
  selection: null as Selection | null,
  past_states: null as Map<string, State> | null, // of the moment of a live run that is shown; null: of now
  logs: [] as LogLine[],
  acts: [] as Act[],
};

const listeners = new Map<Topic, (() => void)[]>();

export function on(topics: Topic | Topic[], work: () => void): void {
  for (const topic of Array.isArray(topics) ? topics : [topics]) {
    if (!listeners.has(topic)) listeners.set(topic, []);
    listeners.get(topic)!.push(work);
  }
}

export function changed(topic: Topic): void {
  for (const work of listeners.get(topic) ?? []) work();
}

export function select(selection: Selection | null): void {
  const now = store.selection;
  if (now?.kind === selection?.kind && now?.id === selection?.id) return;
  store.selection = selection;
  changed('selection');
}

// Why nothing comes, in words.
export function link_problem(): string {
  if (wire.status === 'no token') return 'Open the URL that rtm-studio printed. It contains the access token.';
  if (wire.status === 'forbidden') return 'rtm-studio was restarted and has a new token. Open the URL that it printed.';
  if (wire.damage) return `The data of this page are damaged: ${wire.damage}.`;
  return wire.status === 'lost' ? 'rtm-studio exited. This page reconnects when it runs again.' : wire.status === 'connecting' ? 'Connecting …' : '';
}

export const is_selected = (kind: Kind, id: string): boolean => store.selection?.kind === kind && store.selection.id === id;

// As of the moment that is shown.
export const shown_state = ({ path, state }: Component): State => store.past_states?.get(path) ?? state;

export const component = (path: string): Component | undefined => store.system.components.find((c) => c.path === path);
export const connection = (id: string): Connection | undefined => store.system.connections.find((c) => c.id === id);
export const component_of_port = (port: string): string => port.slice(0, port.lastIndexOf(':'));
export const name_of_port = (port: string): string => port.slice(port.lastIndexOf(':') + 1);
export const connections_of = (port: string): Connection[] => store.system.connections.filter((c) => c.ports.includes(port));

export function port_of(path: string) {
  return component(component_of_port(path))?.ports.find((p) => p.name === name_of_port(path));
}

// The model whose ifaces a component carries: one of its parameters names one.
export function model_of(path: string): string | undefined {
  const models = new Set(store.world?.models.map((m) => m.name));
  for (const set of store.details.get(path)?.sets ?? []) {
    if (!set.active) continue;
    for (const { value } of set.values) {
      const model = value.split('::')[0];
      if (models.has(value) || (value.includes('::') && models.has(model))) return model;
    }
  }
  return undefined;
}

// Those that carry a model's ifaces, and those that are wired to nobody else's.
export function components_of(model: string): string[] {
  return store.system.components.filter((c) => model_of(c.path) === model).map((c) => c.path);
}

// The model that what is selected belongs to.
export function selected_model(): string | undefined {
  const now = store.selection;
  if (!now) return undefined;
  if (now.kind === 'model') return now.id;
  if (now.kind === 'component') return model_of(now.id);
  if (now.kind === 'port') return model_of(component_of_port(now.id));
  if (now.kind === 'iface') return store.world?.ifaces.find((i) => iface_id(i) === now.id)?.model;
  if (now.kind === 'signal') return store.signals.find((s) => s.topic === now.id)?.model;
  return undefined;
}

export const iface_id = (iface: { type: string; name: string }): string => `${iface.type}:${iface.name}`;

export const read_only = (): boolean => store.hello?.read_only ?? false;

// Acts that can be undone and are not answered yet: undo means the last of them, too.
const under_way = new Set<Promise<unknown>>();

// Does something to the system or the world, and remembers it with the command that would have done the same. `after`: what has to be over.
export function act(text: string, name: string, args: object, undo?: (result: any) => Act['undo'], after?: Promise<void>, group?: object): Promise<any> {
  const doing = carry_out(text, name, args, undo, after, group);
  if (undo) {
    under_way.add(doing);
    doing.finally(() => under_way.delete(doing));
  }
  return doing;
}

async function carry_out(text: string, name: string, args: object, undo?: (result: any) => Act['undo'], after?: Promise<void>, group?: object): Promise<any> {
  const done: Act = { text, group };
  try {
    if (after) await after;
    const reply = await wire.request(name, args);
    done.command = reply.command;
    done.undo = undo?.(reply.result);
    return reply.result;
  } catch (error) {
    done.error = (error as Error).message;
    done.command = (error as { command?: string }).command;
    return undefined;
  } finally {
    store.acts.push(done);
    if (store.acts.length > 200) store.acts.shift();
    changed('acts');
  }
}

export async function undo_last(): Promise<void> {
  await Promise.allSettled([...under_way]);
  for (let i = store.acts.length - 1; i >= 0; --i) {
    const { undo, group } = store.acts[i];
    if (!undo) continue;
    const together = store.acts.filter((one) => one.undo && (one === store.acts[i] || (group && one.group === group)));
    await Promise.all(together.map((one) => {
      const { text, name, args } = one.undo!;
      one.undo = undefined;
      return act(text, name, args);
    }));
    return;
  }
}

// Wherever it is asked for: by a button, a key or for all components.
export function state_act(one: { path: string; instance: string }, word: string, name: string, group?: object): Promise<any> {
  const { path, instance } = one;
  const back = { activate: ['Deactivate', 'deactivate'], deactivate: ['Activate', 'activate'] }[name];
  return act(`${word} ${instance}`, name, { path }, back && (() => ({ text: `${back[0]} ${instance}`, name: back[1], args: { path } })), undefined, group);
}

function ask_details(): void {
  const there = new Set(store.system.components.map((c) => c.path));
  for (const path of store.details.keys()) if (!there.has(path)) store.details.delete(path);
  const missing = store.system.components.filter((c) => !store.details.has(c.path) && !c.problem).slice(0, 300);
  for (const { path } of missing) refresh_details(path);
}

// Replies come in any order: one to an earlier question says nothing new.
let asked_details = 0;
const answered_details = new Map<string, number>();

export async function refresh_details(path: string): Promise<void> {
  const number = ++asked_details;
  try {
    const { result } = await wire.request('component', { path });
    if (number < (answered_details.get(path) ?? 0)) return;
    answered_details.set(path, number);
    store.details.set(path, result);
    changed('details');
  } catch { /* it exited meanwhile; the next event of the system says so */ }
}

// Others change parameters, too, and nobody tells of it: of the component that is looked at they are asked for.
setInterval(() => {
  const now = store.selection;
  const path = now?.kind === 'component' ? now.id : undefined;
  if (path && wire.status === 'open' && !store.hello?.recording && !document.hidden && component(path)) refresh_details(path);
}, 2000);

// A recording is shown after a run, or the other way round: nothing that is known holds.
function forget_show(): void {
  Object.assign(store, { system: { revision: 0, problem: '', components: [], connections: [], managers: [] }, has_system: false, world: null, late: null, time: null, signals: [], logs: [], past_states: null, selection: null });
  store.details.clear();
  for (const topic of ['system', 'signals', 'log', 'selection'] as const) changed(topic);
}

wire.on('status', (status) => {
  if (status === 'lost' || status === 'forbidden') {
    store.has_system = false;
    store.details.clear();
  }
  changed('status');
});
wire.on('hello', (hello) => {
  if (store.hello && store.hello.recording?.file !== hello.recording?.file) forget_show();
  store.hello = hello;
  changed('hello');
});
wire.on('system', (system) => {
  store.system = system;
  store.has_system = true;
  changed('system');
  ask_details();
});
wire.on('states', ({ states, rates }) => {
  for (const c of store.system.components) {
    if (states?.[c.path]) c.state = states[c.path] as State;
    const rate = rates?.[c.path];
    if (rate && c.contexts[0]) [c.contexts[0].rate, c.contexts[0].running] = rate;
  }
  changed('states');
});
let models_at_first: WorldEvent['models'] = [];
function put_late(): void {
  const { late, world } = store;
  if (!late || !world) return;
  world.models = [...models_at_first.filter((m) => !late.gone.includes(m.name)), ...late.models.map(({ name }) => ({ name, static: false }))];
}
wire.on('world', (world) => {
  store.world = world;
  models_at_first = world.models;
  put_late();
  changed('world');
});
wire.on('late', (late) => {
  store.late = late;
  put_late();
  changed('world');
});
wire.on('time', (time) => {
  store.time = time;
  changed('time');
});
wire.on('signals', ({ signals }) => {
  store.signals = signals;
  changed('signals');
});
wire.on('logs', ({ lines }) => {
  store.logs.push(...lines);
  if (store.logs.length > 2000) store.logs.splice(0, 500);
  changed('log');
});
