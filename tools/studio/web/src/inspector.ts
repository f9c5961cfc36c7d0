// What is selected, in full, and what can be done with it.
import { Euler } from 'three';
import { in_degrees, in_radians } from './angles';
import { button, h, put, unless_pressed } from './dom';
import { connect_dialog } from './connect_dialog';
import { short_type } from './diagram_parts';
import { ask_text } from './dialog';
import { pose_of } from './glb';
import { Joints } from './joints';
import { inject_dialog, join_dialog } from './rtse_dialogs';
import { fixed, flatten, format, image_iface, iface_type, kind_of_iface, measure, polar, table } from './values';
import { control, is_edited } from './widgets';
import { state_class, state_mark, state_words } from './states';
import {
  act, component, component_of_port, components_of, connection, connections_of, iface_id, is_selected, model_of, name_of_port, on, port_of, read_only, refresh_details, select, state_act, store, wire,
} from './store';
import { replay } from './replay';
import { signal_of_port } from './signal_names';
import { short_path, signal_name } from './tree';
import type { ConfigValue, Context, Values } from './wire';
import { watch } from './watches';
import type { WorldView } from './world';

export interface Parts {
  world: WorldView;
  drive: (iface: string) => void;
  plot: (topic: string, member: string) => void;
  show_image: (iface: string) => void;
  pause_when: (topic: string, members: string[]) => void;
  pauses_on_error: (path: string) => boolean;
  pause_on_error: (path: string) => void; // or not any more
}

type Content = (HTMLElement | string | null | false | HTMLElement[])[];

export class Inspector {
  private newest: unknown; // sample of the signal that is shown
  readonly element = h('div', { class: 'inspector', tabindex: 0, role: 'region', 'aria-label': 'Selection' });
  private shown = '';
  private facts_shown = '';
  private stop: (() => void) | null = null;
  private live: (() => void) | null = null;
  private told = ''; // the model of the selection that the simulator has named
  private ask_again: (() => void) | null = null; // what was asked of a server that has gone, or was not there yet

  readonly joints: Joints;

  constructor(private readonly parts: Parts) {
    this.joints = new Joints(parts.plot);
    on('selection', () => this.show());
    on(['system', 'details', 'world', 'signals', 'hello', 'status', 'states'], () => unless_pressed(this.element, () => this.show()));
    this.element.addEventListener('focusout', () => setTimeout(() => unless_pressed(this.element, () => this.show())));
    on('hello', () => this.ask_again?.());
    on('time', () => this.live?.());
    wire.on('poses', () => this.live?.());
    this.show();
  }

  private show(): void {
    const now = store.selection;
    const key = now ? `${now.kind}:${now.id}` : '';
    // What somebody types in is not taken away, and a list that is open not shut.
    if (key === this.shown && this.element.contains(document.activeElement) && is_edited(document.activeElement!)) return;
    if (key !== this.shown) {
      this.stop?.();
      this.stop = null;
      if (now?.kind !== 'model') this.joints.show('');
      if (now?.kind === 'component') refresh_details(now.id);
    }
    const is_same = key === this.shown;
    // Buttons that stay the same stay the same elements: one may be under a finger.
    const facts = this.facts(now);
    if (is_same && facts === this.facts_shown) return;
    this.facts_shown = facts;
    this.live = null;
    if (!is_same) this.ask_again = null;
    this.shown = key;
    const scroll = this.element.scrollTop;
    const focused = is_same ? (document.activeElement as HTMLElement | null)?.id : '';
    const show = { model: () => this.model(now!.id, is_same), component: () => this.component(now!.id), port: () => this.port(now!.id), connection: () => this.connection(now!.id), signal: () => this.signal(now!.id, is_same), manager: () => this.manager(now!.id, is_same), iface: () => this.iface(now!.id, is_same) };
    const content = now ? show[now.kind]() : this.nothing();
    if (content) put(this.element, content);
    if (is_same) this.element.scrollTop = scroll;
    if (focused) document.getElementById(focused)?.focus();
  }

  // Everything that the content is made of.
  private facts(now: typeof store.selection): string {
    const more = read_only() || wire.status !== 'open';
    if (!now) return String(more);
    const path = now.kind === 'port' ? component_of_port(now.id) : now.id;
    const model = store.world?.models.find((m) => m.name === now.id);
    return JSON.stringify([
      more, now.kind === 'component' && this.parts.pauses_on_error(path), component(path), store.details.get(path), connection(now.id), store.system.connections.filter((c) => c.ports.some((p) => component_of_port(p) === path)), model,
      now.kind === 'model' || now.kind === 'iface' ? [store.world?.ifaces.filter((i) => i.model === now.id || iface_id(i) === now.id), components_of(now.id).map((p) => component(p)?.state), this.parts.world.world?.models.has(now.id)] : 0,
      store.signals.find((s) => s.topic === now.id || s.component === path),
    ]);
  }

  private nothing(): Content {
    return [h('p', { class: 'hint' }, 'Select a robot in the world, a component or line in the system, or anything in the tree.'),
      h('dl', { class: 'keys' }, [['Space', 'run or pause'], ['.', 'one step'], ['/', 'search'], ['T  F  O', 'top, follow, all'], ...(read_only() ? [] : [['G', 'drive the robot']]), ['?', 'all keys']].map(([key, what]) => [h('dt', null, h('kbd', null, key)), h('dd', null, what)]))];
  }

  private title(text: string, kind: string, mark?: Element | null): HTMLElement {
    return h('header', null, mark ?? null, h('h2', null, text), h('span', { class: 'kind' }, kind));
  }

  // ---- worlds ----

  private moving: HTMLElement[] = [];
  private readonly links = h('div', { class: 'links' });

  private model(name: string, is_same: boolean): Content {
    const { world } = this.parts;
    if (!is_same) this.follow_model(name);
    else if (!this.stop) this.follow_velocity(name); // a model that has just come is told before its ifaces
    const model = world.world?.models.get(name);
    const ifaces = store.world?.ifaces.filter((i) => i.model === name && i.type !== 'truth') ?? [];
    const is_told = store.world?.models.some((m) => m.name === name);
    if (is_told) this.told = name;
    if (!is_told && (!model || this.told === name)) { // actors are in the scene alone
      this.live = null;
      return [this.title(name, 'model'), h('p', { class: 'hint' }, 'It does not exist now.')];
    }
    const drive = ifaces.find((i) => i.type === 'position2d' || i.type === 'position3d');
    const pose = h('dl', { class: 'values' });
    const numbers = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'].map((label) => {
      const value = h('dd', null, '–');
      pose.append(h('dt', null, label), value);
      return value;
    });
    this.live = () => {
      const shown = world.world?.models.get(name);
      if (!shown?.canonical) return;
      const { position, quaternion } = pose_of(shown);
      const angles = new Euler().setFromQuaternion(quaternion, 'ZYX');
      const values = [position.x, position.y, position.z, angles.x, angles.y, angles.z];
      numbers.forEach((element, i) => { element.textContent = i < 3 ? `${fixed(values[i], 3)} m` : `${fixed((values[i] * 180) / Math.PI, 1)}°`; });
    };
    this.live();
    this.joints.show(name);
    ['velocity', 'turning'].forEach((label, i) => pose.append(h('dt', null, label), this.moving[i]));
    const can = !read_only();
    return [
      this.title(name, model?.is_static ? 'static model' : ifaces.length > 0 ? 'robot' : 'model'),
      h('div', { class: 'acts' },
        button('Follow with the eye', { icon: 'follow', label: 'Follow', key: 'F' }, () => world.follow(name)),
        drive && can ? button('Drive by keys or stick', { icon: 'drive', label: 'Drive', key: 'G' }, () => this.parts.drive(drive.name)) : null,
        can && !model?.is_static ? button('Set the pose', { label: 'Put …' }, () => put_model(world, name)) : null,
        can && !model?.is_static ? button('Push it', { label: 'Push …' }, () => this.push_model(name)) : null,
        can && !model?.is_static ? button('Set its velocity', { label: 'Set moving …' }, () => this.set_moving(name)) : null,
        can ? button('Delete the model', { label: 'Delete', class: 'danger' }, () => delete_model(name)) : null),
      h('h3', null, 'Pose'), pose, this.joints.element,
      ifaces.length > 0 ? h('h3', null, 'Ifaces') : null,
      h('ul', { class: 'list' }, ifaces.map((i) => h('li', null, link_to(i.name.replace(`${name}::`, ''), { kind: 'iface', id: iface_id(i) }), h('span', { class: 'more' }, i.type)))),
      components_of(name).length > 0 ? h('h3', null, 'Components') : null,
      h('ul', { class: 'list' }, components_of(name).map((path) => h('li', null, state_mark(component(path)?.state), link_to(component(path)?.instance ?? path, { kind: 'component', id: path })))),
      this.links,
    ];
  }

  // Its velocity while it is selected, and once what it is made of.
  private follow_model(name: string): void {
    this.moving = [h('dd', null, '–'), h('dd', null, '–')];
    this.follow_velocity(name);
    put(this.links);
    if (store.hello?.recording) return;
    const ask = () => wire.request('tree', { model: name }).then(({ result }) => {
      if (is_selected('model', name)) put(this.links, tree_of(result.models?.[0]));
    }, () => {});
    ask();
    this.ask_again = ask;
  }

  private follow_velocity(name: string): void {
    const truth = store.world?.ifaces.find((i) => i.type === 'truth' && (i.model === name || i.info?.model === name));
    if (truth) {
      this.stop = watch({ topic: iface_id(truth), hz: 5 }, ({ value }) => {
        const velocity = (value as { velocity?: number[] } | undefined)?.velocity;
        if (velocity?.length !== 6) return;
        const text = (from: number, factor: number, digits: number) => velocity.slice(from, from + 3).map((v) => fixed(v * factor, digits)).join('  ');
        this.moving[0].textContent = `${text(0, 1, 2)} m/s`;
        this.moving[1].textContent = `${text(3, 180 / Math.PI, 1)} °/s`;
      });
    }
  }

  private push_model(name: string): void {
    ask_text(`Push ${name}`, 'FX FY FZ [N] for 0.2 s', '50 0 0', 'Push', (text) => {
      const force = text.split(/[\s,]+/).map(Number);
      if (force.length === 3 && force.every(Number.isFinite)) act(`Push ${name}`, 'push', { name, force, seconds: 0.2 });
    });
  }

  private set_moving(name: string): void {
    ask_text(`Set ${name} moving`, 'VX VY VZ [m/s], or with WX WY WZ [°/s]', '0 0 1', 'Set moving', (text) => {
      const six = text.split(/[\s,]+/).map(Number);
      if ((six.length === 3 || six.length === 6) && six.every(Number.isFinite)) act(`Set ${name} moving`, 'set_velocity', { model: name, linear: six.slice(0, 3), angular: six.length === 6 ? six.slice(3).map(in_radians) : [0, 0, 0] });
    });
  }

  private iface(id: string, is_same: boolean): Content | null {
    const iface = store.world?.ifaces.find((i) => iface_id(i) === id);
    if (!iface) return [this.title(id.split(':').slice(1).join(':'), 'iface'), h('p', { class: 'hint' }, 'It does not exist now.')];
    if (is_same && this.stop) return null;
    const has_picture = iface.type === 'camera' || iface.type === 'rgbd' || iface.type === 'depth';
    const values = h('div');
    const topic = store.signals.find((x) => (x.kind === 'iface' || x.kind === 'image') && x.topic.endsWith('/' + iface.name.replaceAll('::', '/')) && x.topic.includes(`/${iface.type}/`))?.topic;
    if (topic && !has_picture) this.stop = watch({ topic, hz: 5 }, (sample) => this.sample(values, topic, sample));
    return [
      this.title(iface.name, iface.type),
      iface.model ? h('p', null, 'of ', link_to(iface.model, { kind: 'model', id: iface.model })) : null,
      h('div', { class: 'acts' },
        has_picture ? button('Show its images', { icon: 'camera', label: 'Images' }, () => this.parts.show_image(iface_id(iface))) : null,
        has_picture ? button('Look through it', { icon: 'follow', label: 'Look through' }, () => this.parts.world.look_through(iface.name)) : null,
        iface.type.startsWith('position') && !read_only() ? button('Drive by keys or stick', { icon: 'drive', label: 'Drive' }, () => this.parts.drive(iface.name)) : null,
        iface.type === 'position2d' && !read_only() ? [button('Set the odometry to zero', { label: 'Reset odometry', id: 'reset-odometry' }, () => act(`Reset the odometry of ${iface.name}`, 'reset_odometry', { iface: iface.name })),
          ...[true, false].map((on) => button(`Switch the motors ${on ? 'on' : 'off'}`, { label: `Motors ${on ? 'on' : 'off'}`, id: `motors-${on ? 'on' : 'off'}` }, () => act(`Switch the motors of ${iface.name} ${on ? 'on' : 'off'}`, 'set_motors', { iface: iface.name, on },
            () => ({ text: `Switch the motors of ${iface.name} ${on ? 'off' : 'on'}`, name: 'set_motors', args: { iface: iface.name, on: !on } }))))] : null),
      values,
      iface.info && Object.keys(iface.info).length > 0 ? h('h3', null, 'Constants') : null,
      table(flatten(iface.info ?? {}).filter(([key]) => !['type', 'name', 'server', 'model'].includes(key)).map(([key, value]) => [key, measure(key, value, kind_of_iface(iface))])),
    ];
  }

  private signal(topic: string, is_same: boolean): Content | null {
    if (is_same && this.stop) return null;
    const signal = store.signals.find((x) => x.topic === topic);
    if (!signal) return [this.title(topic, 'signal'), h('p', { class: 'hint' }, 'It does not exist now.')];
    const values = h('div', null, h('p', { class: 'hint' }, 'Waiting for a sample …'));
    const rate = h('p', { class: 'hint rate' });
    if (signal.kind !== 'image' && !store.hello?.recording) {
      wire.request('members', { topic }).then(({ result }) => {
        if (values.dataset.shape !== undefined || !is_selected('signal', topic)) return;
        values.append(h('dl', { class: 'values' }, ((result?.members ?? []) as { path: string; type: string }[]).slice(0, 60).map(({ path, type }) => [
          h('dt', null, type === 'text' ? null : button(`Plot ${path}`, { icon: 'plot', class: 'plain small' }, () => this.parts.plot(topic, path)), path), h('dd', null, '–')])));
      }, () => {});
    }
    if (signal.kind === 'image') put(values, button('Show its images', { icon: 'camera', label: 'Images' }, () => this.parts.show_image(image_iface(signal.topic) ?? signal.topic)));
    else {
      this.stop = watch({ topic, hz: 5 }, (sample) => {
        rate.textContent = [sample.rate === undefined ? '' : `${Number(sample.rate.toPrecision(3))} a second`, sample.latency === undefined ? '' : `${(sample.latency * 1000).toFixed(1)} ms after its stamp`].filter(Boolean).join(', ');
        this.sample(values, topic, sample);
      });
    }
    return [
      this.title(signal_name(signal), signal.kind === 'iface' ? signal.type : signal.kind),
      h('p', { class: 'hint' }, topic, signal.kind === 'port' ? `, ${short_type(signal.type)}` : ''),
      signal.model ? h('p', null, 'of ', link_to(signal.model, { kind: 'model', id: signal.model })) : null,
      signal.component ? h('p', null, 'of ', link_to(short_path(signal.component), { kind: 'component', id: signal.component })) : null,
      signal.kind === 'image' || (read_only() && !store.hello?.recording) ? null : h('div', { class: 'acts' }, button('Pause when a value of it becomes true of a comparison', { label: store.hello?.recording ? 'Go to …' : 'Pause when …', id: 'pause-when' }, () => this.ask_break(topic))),
      rate, values,
    ];
  }

  private async ask_break(topic: string): Promise<void> {
    if (store.hello?.recording) return this.parts.pause_when(topic, flatten(this.newest ?? {}).filter(([, value]) => typeof value === 'number').map(([key]) => key));
    const { result } = await wire.request('members', { topic }).catch(() => ({ result: null }));
    this.parts.pause_when(topic, ((result?.members ?? []) as { path: string; type: string }[]).filter((m) => m.type === 'number').map((m) => m.path));
  }

  // The newest sample: each number can go into a plot; long arrays as polar plot.
  private sample(into: HTMLElement, topic: string, sample: Values): void {
    if (sample.error) return put(into, h('p', { class: 'problem' }, sample.error));
    this.newest = sample.value;
    const all = flatten(sample.value ?? {});
    const scan = (sample.value as { ranges?: number[] } | undefined)?.ranges;
    // Values change in place: a button that is held must not go.
    if (into.dataset.shape !== all.map(([key]) => key).join()) {
      into.dataset.shape = all.map(([key]) => key).join();
      put(into, h('h3', null, 'Values'), scan ? h('canvas', { width: 260, height: 170, class: 'polar', role: 'img', 'aria-label': 'The scan from above' }) : null,
        h('dl', { class: 'values' }, all.slice(0, 60).map(([key, value]) => [
          h('dt', null, typeof value === 'number' ? button(`Plot ${key}`, { icon: 'plot', class: 'plain small' }, () => this.parts.plot(topic, key)) : null, key), h('dd')])),
        all.length > 60 ? h('p', { class: 'hint' }, `and ${all.length - 60} more`) : null);
    }
    const cells = into.querySelectorAll('dd');
    const type = iface_type(topic);
    all.slice(0, 60).forEach(([key, value], i) => { if (cells[i]) cells[i].textContent = measure(key, value, type); });
    const canvas = into.querySelector('canvas');
    if (scan && canvas) polar(canvas, scan, sample.value as { [key: string]: unknown });
  }

  // ---- systems ----

  private component(path: string): Content {
    const one = component(path);
    if (!one) return [this.title(short_path(path), 'component'), h('p', { class: 'hint' }, 'It does not exist now.')];
    const detail = store.details.get(path);
    const can = !read_only();
    const does = (text: string, name: string, enabled: boolean, danger = false) => button(`${text} ${one.instance}`, { label: text, disabled: !enabled, class: danger ? 'danger' : undefined, id: `act-${name}` }, () => state_act(one, text, name));
    const model = model_of(path);
    return [
      this.title(one.instance, one.instance.replace(/\d+$/, '') === one.type ? '' : one.type, state_mark(one.state)),
      h('p', { class: `state ${state_class(one.state)}` }, `is ${state_words[one.state] ?? one.state}`, model ? ', bridges ' : '', model ? link_to(model, { kind: 'model', id: model }) : null),
      one.problem ? h('p', { class: 'problem' }, one.problem) : null,
      one.state === 'Error' ? h('p', { class: 'hint' }, 'Reset takes it from the error state to inactive; its log says what was wrong.') : null,
      can ? h('div', { class: 'acts' },
        does('Activate', 'activate', one.state === 'Inactive'),
        does('Deactivate', 'deactivate', one.state === 'Active'),
        does('Reset', 'reset', one.state === 'Error'), does('Exit', 'exit', true, true),
        one.in_simulated_time ? does('Leave', 'leave_time', true) : button(`Add ${one.instance} to simulated time`, { label: 'Join …', id: 'act-join_time' }, () => join_dialog(one)),
        store.system.connections.some((c) => c.ports.some((p) => component_of_port(p) === path)) ? button(`Disconnect all ${one.instance}`, { label: 'Disconnect all', id: 'act-disconnect_all' }, () => disconnect_all(store.system.connections.filter((c) => c.ports.some((p) => component_of_port(p) === path)))) : null,
        button(`Pause the simulation when ${one.instance} enters the error state`, { label: 'Pause on error', id: 'pause-on-error', pressed: this.parts.pauses_on_error(path) }, () => this.parts.pause_on_error(path)),
        one.problem ? does('Forget', 'forget', true, true) : null) : null,
      store.hello?.recording?.file.endsWith('.mcap') ? h('div', { class: 'acts' }, button('Send the recorded inputs to this component again and compare its outputs', { label: 'Replay', id: 'replay' }, () => replay(one.instance))) : null,
      h('h3', null, 'Contexts'),
      one.contexts.map((context) => this.context(path, context, one.contexts.length === 1)),
      one.ports.length > 0 ? h('h3', null, 'Ports') : null,
      h('ul', { class: 'list' }, one.ports.map((port) => {
        const id = `${path}:${port.name}`, wires = connections_of(id).length;
        return h('li', null, link_to(port.name, { kind: 'port', id }), h('span', { class: 'more' }, `${port.kind} ${short_type(port.data_type).replace(/^RTC\//, '')}${wires > 0 ? `, ${wires} wired` : ''}`));
      })),
      ...this.sets(path),
      h('h3', null, 'About'),
      table([['category', one.category ?? ''], ['vendor', one.vendor ?? ''], ['version', one.version ?? ''], ['description', one.description ?? ''], ['path', path], ...(one.composite ? [['members', (one.members ?? []).join(', ')] as [string, string]] : [])].filter(([, value]) => value) as [string, string][]),
      detail?.properties && Object.keys(detail.properties).length > 0 ? h('details', null, h('summary', null, 'Properties'), table(Object.entries(detail.properties))) : null,
    ];
  }

  // Of a component with several each has a state of its own.
  private acts_in(path: string, { index, state }: Context): HTMLElement[] {
    const now = store.details.get(path)?.contexts.find((c) => c.index === index)?.state ?? state;
    const ways: [string, string, string][] = [['Inactive', 'activate', 'Activate'], ['Active', 'deactivate', 'Deactivate'], ['Error', 'reset', 'Reset']];
    return ways.filter(([from]) => from === now).map(([, name, word]) => button(`${word} ${short_path(path)} in context ${index}`, { label: word, id: `${name}-in-${index}` },
      () => act(`${word} ${short_path(path)} in context ${index}`, name, { path, context: index }).then(() => refresh_details(path))));
  }

  private context(path: string, context: Context, is_one: boolean): HTMLElement {
    const id = `rate-${context.index}`;
    const rate = h('input', { id, type: 'number', min: 0.001, step: 'any', value: context.rate ?? '', class: 'number', disabled: read_only(), 'data-known': String(context.rate ?? '') });
    rate.addEventListener('change', () => { rate.dataset.known = rate.value; act(`Set the rate of ${short_path(path)}`, 'set_rate', { path, context: context.index, rate: Number(rate.value) },
      () => (context.rate === null ? undefined : { text: `Set the rate of ${short_path(path)} back`, name: 'set_rate', args: { path, context: context.index, rate: context.rate } })); });
    return h('div', { class: 'line' }, h('label', { for: id }, `${context.index}${context.owned ? '' : ' (joined)'}`), rate, h('span', null, 'Hz'), h('span', { class: 'more' }, context.running ? 'runs' : 'stopped'),
      read_only() ? null : button(context.running ? `Stop context ${context.index}` : `Start context ${context.index}`, { label: context.running ? 'Stop' : 'Start', id: `context-${context.index}` },
        () => act(`${context.running ? 'Stop' : 'Start'} a context of ${short_path(path)}`, context.running ? 'stop_context' : 'start_context', { path, context: context.index })),
      read_only() || is_one ? null : this.acts_in(path, context));
  }

  private sets(path: string): Content {
    const sets = store.details.get(path)?.sets ?? [];
    if (sets.length === 0) return [];
    const out: Content = [h('h3', null, 'Configuration')];
    for (const set of sets) {
      if (sets.length > 1) {
        out.push(h('div', { class: 'line' }, h('label', null, h('input', { type: 'radio', name: 'set', checked: set.active, disabled: read_only(), onchange: () => act(`Use set ${set.id} of ${short_path(path)}`, 'use_set', { path, set: set.id }).then(() => refresh_details(path)) }), ` ${set.id}`)));
      }
      out.push(h('div', { class: 'grid' }, set.values.flatMap((value, i) => this.parameter(path, set.id, value, i))));
    }
    return out;
  }

  private parameter(path: string, set: string, value: ConfigValue, i: number): HTMLElement[] {
    const id = `conf-${set}-${i}`;
    const change = async (text: string, force = false) => {
      document.getElementById(`${id}-force`)?.remove();
      if (text === value.value) return;
      const done = await act(`Set ${value.name} of ${short_path(path)}`, 'set_configuration', { path, set, values: { [value.name]: text }, force },
        () => ({ text: `Set ${value.name} of ${short_path(path)} back`, name: 'set_configuration', args: { path, set, values: { [value.name]: value.value }, force } }));
      const field = document.getElementById(id);
      if (!done && field) {
        field.setAttribute('aria-invalid', 'true'); // what is typed stays, to be mended
        const can_force = !force && wire.status === 'open';
        if (can_force) field.after(button(`Set ${value.name} to ${text}, although the component rejected it`, { label: 'Set anyway', id: `${id}-force`, class: 'danger' }, () => change(text, true)));
      }
      await refresh_details(path);
    };
    const title = [value.type, value.constraint].filter(Boolean).join(', ');
    return [h('label', { for: id, title }, value.name), control(value, id, change)];
  }

  private port(id: string): Content {
    const port = port_of(id), path = component_of_port(id);
    if (!port) return [this.title(name_of_port(id), 'port'), h('p', { class: 'hint' }, 'It does not exist now.')];
    const signal = signal_of_port(id);
    const detail = store.details.get(path)?.ports.find((p) => p.name === port.name);
    return [
      this.title(port.name, { in: 'InPort', out: 'OutPort', service: 'service port' }[port.kind]),
      h('p', null, 'of ', link_to(component(path)?.instance ?? path, { kind: 'component', id: path }), port.data_type ? `, ${short_type(port.data_type)}` : ''),
      h('div', { class: 'acts' }, read_only() ? null : button('Connect this port', { icon: 'link', label: 'Connect …', key: 'C', id: 'connect' }, () => connect_dialog(id)),
        port.kind === 'in' && !read_only() ? button('Write a value to this port', { label: 'Write …', id: 'inject' }, () => inject_dialog(id, port.data_type)) : null,
        connections_of(id).length > 1 && !read_only() ? button('Cut all connections of this port', { label: 'Disconnect all', id: 'disconnect-all' }, () => disconnect_all(connections_of(id))) : null,
        signal ? button('Show its values', { icon: 'plot', label: 'Values' }, () => select({ kind: 'signal', id: signal.topic })) : null),
      connections_of(id).length > 0 ? h('h3', null, 'Connections') : null,
      h('ul', { class: 'list' }, connections_of(id).map((c) => h('li', null, link_to(c.name || c.ports.map(name_of_port).join(' – '), { kind: 'connection', id: c.id }),
        h('span', { class: 'more' }, c.ports.filter((p) => p !== id).map((p) => `${component(component_of_port(p))?.instance ?? short_path(component_of_port(p))}:${name_of_port(p)}`).join(', '))))),
      port.interfaces?.length ? h('h3', null, 'Interfaces') : null,
      table((port.interfaces ?? []).map((i) => [i.instance, `${i.type}, ${i.provided ? 'provided' : 'required'}`])),
      detail?.properties ? h('details', null, h('summary', null, 'Properties'), table(Object.entries(detail.properties))) : null,
    ];
  }

  private connection(id: string): Content {
    const one = connection(id);
    if (!one) return [this.title('Connection', ''), h('p', { class: 'hint' }, 'It does not exist now.')];
    return [
      this.title(one.name || 'Connection', 'connection'),
      h('ul', { class: 'list' }, one.ports.map((p) => h('li', null, link_to(`${component(component_of_port(p))?.instance ?? short_path(component_of_port(p))}:${name_of_port(p)}`, { kind: 'port', id: p }))),
        (one.absent ?? []).map((text) => h('li', { class: 'more' }, text))),
      h('div', { class: 'acts' }, read_only() ? null : button('Disconnect', { label: 'Disconnect', class: 'danger', key: 'Delete', id: 'disconnect' }, () => disconnect(id))),
      h('h3', null, 'Properties'), table(Object.entries(one.properties).map(([key, value]) => [key.replace(/^dataport\./, ''), value])),
    ];
  }

  private manager(path: string, is_same: boolean): Content | null {
    if (is_same && this.stop) return null;
    const body = h('div', null, h('p', { class: 'hint' }, 'Loading …'));
    let asked = 0;
    const refresh = async () => {
      const number = ++asked;
      let content: Content;
      try {
        content = this.manager_body(path, (await wire.request('manager', { path })).result, refresh);
      } catch (error) {
        content = [h('p', { class: 'problem' }, (error as Error).message)];
      }
      if (number === asked) unless_pressed(body, () => put(body, content));
    };
    refresh();
    this.ask_again = refresh;
    this.stop = () => {};
    return [this.title(short_path(path), 'manager'), body];
  }

  private manager_body(manager: string, info: any, refresh: () => void): Content {
    const can = !read_only();
    const types: string[] = (info.factories ?? []).map((f: any) => f.type);
    return [
      can ? h('div', { class: 'acts' },
        button('Load a module', { label: 'Load …', id: 'manager-load' }, () => ask_text('Load a module', 'File, or FILE FUNCTION', info.loadable?.[0]?.file ?? '', 'Load',
          (text) => { const [file, init] = text.split(/\s+/); act(`Load ${file}`, 'load_module', { manager, file, init }).then(refresh); }, (info.loadable ?? []).map((l: any) => l.file))),
        button('Create a component', { label: 'Create …', id: 'manager-create' }, () => ask_text('Create a component', 'Type, or TYPE?instance_name=NAME&KEY=VALUE', types[0] ?? '', 'Create',
          (type) => act(`Create ${type}`, 'create', { manager, type }).then(refresh), [...types, ...(info.loadable ?? []).map((l: any) => l.type)]))) : null,
      h('h3', null, 'Components'),
      h('ul', { class: 'list' }, (info.components ?? []).map((c: any) => h('li', null, h('span', null, c.instance), h('span', { class: 'more' }, c.type),
        can ? button(`Delete ${c.instance}`, { icon: 'close', class: 'plain small' }, () => act(`Delete ${c.instance}`, 'delete_component', { manager, instance: c.instance }).then(refresh)) : null))),
      h('h3', null, 'Can create'), h('ul', { class: 'list' }, types.map((type) => h('li', null, h('span', null, type), can ? button(`Create ${type}`, { icon: 'plus', class: 'plain small' }, () => act(`Create ${type}`, 'create', { manager, type }).then(refresh)) : null))),
      (info.loaded ?? []).length > 0 ? h('h3', null, 'Loaded') : null,
      h('ul', { class: 'list' }, (info.loaded ?? []).map((file: string) => h('li', null, h('span', { title: file }, file.split('/').pop() ?? file),
        can ? button(`Unload ${file}`, { icon: 'close', class: 'plain small' }, () => act(`Unload ${file}`, 'unload_module', { manager, file }).then(refresh)) : null))),
      (info.loadable ?? []).length > 0 ? h('h3', null, 'Can load') : null,
      h('ul', { class: 'list' }, (info.loadable ?? []).map((l: any) => h('li', null, h('span', null, l.type || l.file), can ? button(`Load ${l.file}`, { icon: 'plus', class: 'plain small' }, () => act(`Load ${l.file}`, 'load_module', { manager, file: l.file }).then(refresh)) : null))),
    ];
  }
}

export function put_model(world: WorldView, name: string): void {
  const model = world.world?.models.get(name);
  const pose = model?.canonical ? pose_of(model) : null;
  const start = pose ? [pose.position.x, pose.position.y, new Euler().setFromQuaternion(pose.quaternion, 'ZYX').z] : [0, 0, 0];
  const from = pose ? [...pose.position.toArray(), pose.quaternion.w, pose.quaternion.x, pose.quaternion.y, pose.quaternion.z] : null;
  ask_text(`Put ${name}`, 'X Y YAW [m, m, °]', [...start.slice(0, 2).map((v) => v.toFixed(3)), in_degrees(start[2]).toFixed(1)].join(' '), 'Put', (text) => {
    const [x, y, yaw, ...more] = text.split(/[\s,]+/).map(Number);
    const planar = [x, y, in_radians(yaw), ...more];
    if (planar.length === 3 && planar.every(Number.isFinite)) {
      act(`Put ${name}`, 'set_pose', { model: name, planar }, () => ({ text: `Put ${name} back`, name: 'set_pose', args: from ? { model: name, pose: from } : { model: name, planar: start } }));
    }
  });
}

// Undo restores it as it was.
export function delete_model(name: string): void {
  if (!read_only()) act(`Delete ${name}`, 'delete_model', { model: name }, () => ({ text: `Restore ${name}`, name: 'restore_model', args: { model: name } }));
}

// Nothing runs beside a recording: what replays a component is a command, which the status line shows for copying.
export function disconnect_all(all: { id: string }[]): void {
  const group = {};
  for (const { id } of all) disconnect(id, group);
}

export function disconnect(id: string, group?: object): void {
  const one = connection(id);
  if (!one || read_only()) return;
  const port = one.ports.find((p) => port_of(p)) ?? one.ports[0];
  act(`Disconnect ${one.name || one.ports.map(name_of_port).join(' and ')}`, 'disconnect', { port, id }, (result) => ({
    text: `Connect ${one.name} again`, name: 'connect', args: { ports: result.ports ?? one.ports, name: result.name ?? one.name, id, properties: result.properties ?? one.properties },
  }), undefined, group).then(() => { if (is_selected('connection', id)) select(null); });
}

function link_to(text: string, selection: { kind: any; id: string }): HTMLElement {
  return h('button', { type: 'button', class: 'link', onclick: () => select(selection) }, text);
}

// What a model is made of, as `simctl tree` tells it.
function tree_of(model: any): Content {
  if (!model) return [];
  const list = (title: string, all: any[], more: (one: any) => string) => (all?.length ? h('details', null, h('summary', null, `${all.length} ${title}${all.length === 1 ? '' : 's'}`),
    h('ul', { class: 'list' }, all.slice(0, 200).map((one) => h('li', null, h('span', null, one.name), h('span', { class: 'more' }, more(one)))))) : null);
  return [list('link', model.links, (l) => (typeof l.mass === 'number' ? `${format(l.mass)} kg` : '')), list('joint', model.joints, (j) => [j.type, j.parent && j.child ? `${j.parent} – ${j.child}` : ''].filter(Boolean).join(', ')),
    list('plugin', model.plugins, (p) => p.filename ?? '')];
}
