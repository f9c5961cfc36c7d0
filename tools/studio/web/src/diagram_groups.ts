// Equal robots of a fleet, for the diagram. A robot is the components whose names have the same number: Laser_r7, Drive_r7. Robots are equal
// when they have the same components, types, ports and connections, but for the number; the first of them stands for all.
import { component_of_port, name_of_port } from './store';
import type { Component, State, System } from './wire';

export interface Groups { members: Map<string, Component[]>; hidden: Set<string> } // by the path of the one that is shown; the others

const least = 4; // that make a group

const parts_of_name = (name: string) => /^(.*?)(\d+)(\D*)$/.exec(name);

export function equal_robots({ components, connections }: System): Groups {
  const robots = new Map<string, Map<string, Component>>(); // by number; its components by their names without it
  const robot_of = new Map<string, [string, string]>(); // path: number, name without it
  for (const one of components) {
    const parts = parts_of_name(one.instance);
    if (!parts) continue;
    const [, before, number, after] = parts, name = `${before}#${after}`;
    if (!robots.has(number)) robots.set(number, new Map());
    if (robots.get(number)!.has(name)) continue; // of another host
    robots.get(number)!.set(name, one);
    robot_of.set(one.path, [number, name]);
  }
  const wires = new Map<string, string[]>();
  for (const { ports } of connections) {
    const owners = ports.map((port) => robot_of.get(component_of_port(port)));
    for (const number of new Set(owners.map((owner) => owner?.[0]))) {
      if (number === undefined) continue;
      const ends = ports.map((port, i) => `${owners[i]?.[0] === number ? owners[i]![1] : component_of_port(port)}:${name_of_port(port)}`);
      wires.set(number, [...(wires.get(number) ?? []), ends.sort().join(' ')]);
    }
  }
  const equal = new Map<string, Map<string, Component>[]>();
  for (const [number, robot] of [...robots].sort(([a], [b]) => Number(a) - Number(b))) {
    const kinds = [...robot].map(([name, one]) => `${name} ${one.type} ${one.ports.map((p) => `${p.kind}:${p.name}`).join(' ')}`);
    const key = JSON.stringify([kinds.sort(), (wires.get(number) ?? []).sort()]);
    equal.set(key, [...(equal.get(key) ?? []), robot]);
  }
  const groups: Groups = { members: new Map(), hidden: new Set() };
  for (const all of equal.values()) {
    if (all.length < least) continue;
    for (const [name, one] of all[0]) groups.members.set(one.path, all.map((robot) => robot.get(name)!));
    for (const robot of all.slice(1)) for (const one of robot.values()) groups.hidden.add(one.path);
  }
  return groups;
}

// What concerns somebody comes first: one in error, one that does not answer.
export function state_of_all(states: State[]): State {
  for (const state of ['Error', 'Unknown', 'Inactive', 'Created'] as const) if (states.includes(state)) return state;
  return states[0] ?? 'Unknown';
}

// "48 active, 2 in error"
export function count_of_states(states: State[], words: { [state in State]: string }): string {
  const counts = new Map<State, number>();
  for (const state of states) counts.set(state, (counts.get(state) ?? 0) + 1);
  return [...counts].map(([state, count]) => `${count} ${words[state]}`).join(', ');
}
