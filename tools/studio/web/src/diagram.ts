// The system as RTSystemEditor draws it: boxes with ports, lines between them; live.
import { button, h, once_a_frame, put, s, unless_pressed, with_code } from './dom';
import { connect_dialog } from './connect_dialog';
import { count_of_states, equal_robots, state_of_all } from './diagram_groups';
import { arrange, Place } from './diagram_layout';
import { curve, rate_text, short_type, type_text } from './diagram_parts';
import { component_menu, port_menu, wire_menu } from './menus';
import { keep, settings } from './settings';
import { state_class, state_shape, state_words } from './states';
import {
  component, component_of_port, components_of, connections_of, is_selected, link_problem, name_of_port, on, port_of, read_only, select, selected_model, shown_state, store, wire,
} from './store';
import type { Component, Connection, Port, State } from './wire';

interface Shape { element: SVGGElement; width: number; height: number; ports: Map<string, { x: number; y: number; element: SVGGElement; port: Port }>; component: Component; mark: SVGPathElement; rate: SVGTextElement; is_out: boolean }

const letter = 6.4, row = 17, head = 40;

export class Diagram {
  readonly element = h('div', { class: 'diagram' });
  readonly canvas = s('svg', { tabindex: 0, role: 'application', 'aria-label': 'System: arrow keys go from component to component, brackets from port to port, c connects' });
  private readonly plane = s('g');
  private readonly lines = s('g', { class: 'lines' });
  private readonly boxes = s('g');
  private readonly ghost = s('path', { class: 'ghost', d: '' });
  private readonly notice = h('div', { class: 'notice', role: 'status' });
  private shapes = new Map<string, Shape>();
  private edges = new Map<string, { element: SVGGElement; paths: SVGPathElement[]; connection: Connection }>();
  private places = new Map<string, Place>();
  private groups = equal_robots({ ...store.system, components: [], connections: [] }); // folded
  private pan = { x: 20, y: 20, scale: 1 };
  private slid = { x: 0, y: 0 };
  private has_panned = false; // by a person: the view stays

  private redraw = once_a_frame(() => unless_pressed(this.canvas, () => this.build()));
  frames = 0;
  plot: (topic: string) => void = () => {}; // where the first number of a signal goes

  constructor() {
    this.plane.append(this.lines, this.boxes, this.ghost);
    this.canvas.append(this.plane);
    this.element.append(this.canvas, this.notice);
    on(['system', 'status', 'hello'], () => this.redraw());
    on('states', () => this.show_states());
    on(['selection', 'details'], once_a_frame(() => this.show_selection()));
    new ResizeObserver(() => { if (!this.has_panned) this.fit(); }).observe(this.element);
    this.listen();
  }

  // ---- drawing ----

  private build(): void {
    const { system } = store;
    this.notice_state();
    this.boxes.replaceChildren();
    this.lines.replaceChildren();
    this.shapes.clear();
    this.edges.clear();
    this.groups = equal_robots(settings.folded ? system : { ...system, components: [], connections: [] });
    for (const one of system.components) if (!this.groups.hidden.has(one.path)) this.add_box(one);
    this.place_boxes();
    for (const one of system.connections) this.add_line(one);
    this.show_selection();
    if (!this.has_panned && system.components.length > 0) this.fit();
    else this.cull();
  }

  private notice_state(): void {
    const { system, hello } = store;
    const server = hello?.name_server ?? 'localhost:2809';
    const start = hello?.start ? `: \`${hello.start.components}\`` : '';
    let text = '';
    if (wire.status !== 'open') text = store.system.components.length > 0 ? '' : link_problem();
    else if (hello?.recording) text = store.has_system && system.components.length === 0 ? 'This recording has no components.' : '';
    else if (system.problem) text = `No name server responds at ${server}. Start one with components${start}. It appears here automatically.`;
    else if (store.has_system && system.components.length === 0) text = `The name server at ${server} has no components. Start some${start}, or create them in a manager of the tree.`;
    this.element.classList.toggle('stale', wire.status !== 'open' && wire.status !== 'connecting');
    put(this.notice, text ? h('div', { class: 'card' }, h('p', null, ...with_code(text))) : null);
  }

  // Of all that the box stands for.
  private states_of(one: Component): State[] {
    return (this.groups.members.get(one.path) ?? [one]).map((each) => shown_state(component(each.path) ?? each));
  }

  private title_of(one: Component, states: State[]): string {
    if (states.length > 1) return `${one.instance} and ${states.length - 1} like it (${one.type}): ${count_of_states(states, state_words)}`;
    return `${one.instance} (${one.type}) is ${state_words[states[0]] ?? states[0]}${one.problem ? `: ${one.problem}` : ''}`;
  }

  private add_box(one: Component): void {
    const ins = one.ports.filter((p) => p.kind === 'in'), outs = one.ports.filter((p) => p.kind === 'out'), services = one.ports.filter((p) => p.kind === 'service');
    const long = (ports: Port[]) => Math.max(0, ...ports.map((p) => p.name.length)) * letter;
    const service_width = services.reduce((sum, p) => sum + Math.max(30, p.name.length * 5.6 + 16), 8);
    const width = Math.ceil(Math.max(118, one.instance.length * 7.2 + (this.groups.members.has(one.path) ? 74 : 40), type_text(one).length * 5.8 + 70, long(ins) + long(outs) + 48, service_width));
    const height = head + Math.max(1, Math.max(ins.length, outs.length)) * row + 6 + (services.length > 0 ? 22 : 0);
    const states = this.states_of(one), state = state_of_all(states), is_folded = states.length > 1;
    const mark = s('path', { class: 'shape', d: state_shape(state), transform: 'translate(8 8) scale(1.1)' });
    const rate = s('text', { class: 'rate', x: width - 9, y: 32, 'text-anchor': 'end' }, rate_text(one));
    const element = s('g', { class: `box ${state_class(state)}${one.composite ? ' composite' : ''}${is_folded ? ' folded' : ''}`, 'data-path': one.path },
      is_folded ? s('rect', { class: 'outer', x: 5, y: 5, width, height, rx: 3 }) : null,
      one.composite ? s('rect', { class: 'outer', x: -3, y: -3, width: width + 6, height: height + 6, rx: 5 }) : null,
      s('rect', { class: 'frame', width, height, rx: 3 }), s('path', { class: 'band', d: `M0 3a3 3 0 0 1 3-3h${width - 6}a3 3 0 0 1 3 3v21H0z` }), mark,
      s('text', { class: 'name', x: 24, y: 17 }, one.instance), is_folded ? s('text', { class: 'count', x: width - 9, y: 17, 'text-anchor': 'end' }, `× ${states.length}`) : null,
      s('text', { class: 'type', x: 9, y: 32 }, type_text(one)), rate,
      s('title', null, this.title_of(one, states)));
    const shape: Shape = { element, width, height, ports: new Map(), component: one, mark, rate, is_out: false };
    ins.forEach((port, i) => this.add_port(shape, port, 0, head + 9 + i * row));
    outs.forEach((port, i) => this.add_port(shape, port, width, head + 9 + i * row));
    let x = 4;
    for (const port of services) {
      const wide = Math.max(30, port.name.length * 5.6 + 16);
      this.add_port(shape, port, x + wide / 2, height);
      x += wide;
    }
    this.shapes.set(one.path, shape);
    this.boxes.append(element);
  }

  private add_port(shape: Shape, port: Port, x: number, y: number): void {
    const path = `${shape.component.path}:${port.name}`;
    const is_wired = connections_of(path).length > 0;
    const forms = { in: 'M-7-5h7l5 5-5 5h-7z', out: 'M-5-5h7l5 5-5 5h-7z', service: 'M-5-5h10v10h-10z' };
    const label = port.kind === 'service' ? s('text', { class: 'label', y: -9, 'text-anchor': 'middle' }, port.name)
      : s('text', { class: 'label', x: port.kind === 'in' ? 10 : -10, y: 4, 'text-anchor': port.kind === 'in' ? 'start' : 'end' }, port.name);
    const element = s('g', { class: `port ${port.kind}${is_wired ? ' wired' : ''}`, transform: `translate(${x} ${y})`, 'data-port': path },
      s('rect', { class: 'reach', x: port.kind === 'out' ? -22 : -10, y: -9, width: 32, height: 18 }), s('path', { d: forms[port.kind] }), label,
      s('title', null, `${port.name}: ${port.kind === 'service' ? 'service port' : port.kind === 'in' ? 'InPort' : 'OutPort'} ${short_type(port.data_type)}`));
    shape.ports.set(port.name, { x, y, element, port });
    shape.element.append(element);
  }

  private place_boxes(): void {
    const boxes = [...this.shapes].map(([path, { width, height }]) => ({ path, width, height }));
    const missing = boxes.filter((b) => !settings.positions[b.path]);
    if (missing.length > 0) {
      const edges = store.system.connections.filter((c) => c.ports.length >= 2).map((c): [string, string] => {
        const [a, b] = c.ports;
        return port_of(a)?.kind === 'in' ? [component_of_port(b), component_of_port(a)] : [component_of_port(a), component_of_port(b)];
      });
      const placed = arrange(boxes, edges);
      const kept = boxes.filter((b) => settings.positions[b.path]);
      // What was placed by hand stays; what is new stands below it when the two would meet.
      const low = kept.length > 0 ? Math.max(...kept.map((b) => settings.positions[b.path][1] + b.height)) + 30 : 0;
      const high = Math.min(...missing.map((b) => placed.get(b.path)!.y));
      for (const { path } of missing) {
        const place = placed.get(path)!;
        this.places.set(path, kept.length > 0 ? { x: place.x, y: place.y - high + low } : place);
      }
    }
    for (const { path } of boxes) {
      const fixed = settings.positions[path];
      if (fixed) this.places.set(path, { x: fixed[0], y: fixed[1] });
      this.move_box(path);
    }
  }

  private move_box(path: string): void {
    const place = this.places.get(path)!;
    this.shapes.get(path)?.element.setAttribute('transform', `translate(${place.x} ${place.y})`);
  }

  private at(port: string): { x: number; y: number; kind: string } | null {
    const path = component_of_port(port);
    const shape = this.shapes.get(path), place = this.places.get(path), spot = shape?.ports.get(name_of_port(port));
    if (!spot || !place) return null;
    const out = spot.port.kind === 'out' ? 7 : spot.port.kind === 'in' ? -7 : 0;
    return { x: place.x + spot.x + out, y: place.y + spot.y + (spot.port.kind === 'service' ? 6 : 0), kind: spot.port.kind };
  }

  private add_line(one: Connection): void {
    const ends = one.ports.map((p) => this.at(p)).filter((p) => p !== null);
    if (ends.length < 2) return;
    const paths = ends.slice(1).map(() => s('path', { class: 'line' }));
    const element = s('g', { class: 'edge', 'data-connection': one.id }, paths.map((p) => [s('path', { class: 'reach' }), p]), s('title', null, one.name || one.ports.map(name_of_port).join(' to ')));
    this.edges.set(one.id, { element, paths, connection: one });
    this.lines.append(element);
    this.lead_line(one.id);
  }

  private lead_line(id: string): void {
    const edge = this.edges.get(id);
    if (!edge) return;
    const ends = edge.connection.ports.map((p) => this.at(p)).filter((p) => p !== null);
    const first = ends.find((e) => e.kind !== 'in') ?? ends[0];
    ends.filter((e) => e !== first).forEach((end, i) => {
      const d = curve(first, end);
      edge.paths[i]?.setAttribute('d', d);
      edge.paths[i]?.previousElementSibling?.setAttribute('d', d);
    });
  }

  private show_states(): void {
    for (const [path, shape] of this.shapes) {
      const now = component(path);
      if (!now) continue;
      shape.component = now;
      const states = this.states_of(now), state = state_of_all(states);
      shape.element.setAttribute('class', `box ${state_class(state)}${now.composite ? ' composite' : ''}${states.length > 1 ? ' folded' : ''}${shape.element.classList.contains('chosen') ? ' chosen' : ''}${shape.element.classList.contains('related') ? ' related' : ''}`);
      shape.mark.setAttribute('d', state_shape(state));
      shape.rate.textContent = rate_text(now);
      shape.element.querySelector(':scope > title')!.textContent = this.title_of(now, states);
    }
  }

  private show_selection(): void {
    const model = selected_model();
    const related = new Set(model ? components_of(model) : []);
    for (const [path, { element, ports }] of this.shapes) {
      element.classList.toggle('chosen', is_selected('component', path));
      element.classList.toggle('related', related.has(path));
      for (const [name, spot] of ports) spot.element.classList.toggle('chosen', is_selected('port', `${path}:${name}`));
    }
    for (const [id, { element, connection }] of this.edges) {
      element.classList.toggle('chosen', is_selected('connection', id));
      element.classList.toggle('related', connection.ports.some((p) => is_selected('port', p) || is_selected('component', component_of_port(p))));
    }
  }

  // ---- looking ----

  private apply_pan(): void {
    const { x, y, scale } = this.pan;
    this.slid = { x: 0, y: 0 };
    this.canvas.style.transform = '';
    this.plane.setAttribute('transform', `translate(${x} ${y}) scale(${scale})`);
    this.canvas.classList.toggle('far', scale < 0.42);
    this.canvas.classList.toggle('very-far', scale < 0.22);
    this.cull();
    this.frames += 1;
  }

  // While it is dragged, what is drawn is only moved, and drawn anew when half of the picture has gone by.
  private slide(dx: number, dy: number): void {
    this.pan.x += dx;
    this.pan.y += dy;
    this.slid.x += dx;
    this.slid.y += dy;
    if (Math.abs(this.slid.x) > this.element.clientWidth / 2 || Math.abs(this.slid.y) > this.element.clientHeight / 2) return this.apply_pan();
    this.canvas.style.transform = `translate(${this.slid.x}px,${this.slid.y}px)`;
    this.frames += 1;
  }

  // Boxes far outside are not drawn.
  private cull(): void {
    if (this.shapes.size < 60) return;
    const { clientWidth: width, clientHeight: height } = this.element;
    const { x, y, scale } = this.pan;
    for (const [path, shape] of this.shapes) {
      const place = this.places.get(path);
      if (!place) continue;
      const left = place.x * scale + x, top = place.y * scale + y;
      const is_out = left > 1.6 * width || top > 1.6 * height || left + shape.width * scale < -0.6 * width || top + shape.height * scale < -0.6 * height;
      if (is_out === shape.is_out) continue;
      shape.is_out = is_out;
      shape.element.style.display = is_out ? 'none' : '';
    }
  }

  fit(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (this.shapes.size === 0 || width < 10 || height < 10) return this.apply_pan();
    let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const [path, shape] of this.shapes) {
      const { x, y } = this.places.get(path)!;
      [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x + shape.width), Math.max(bottom, y + shape.height)];
    }
    const scale = Math.min(1.15, (width - 28) / (right - left), (height - 28) / (bottom - top));
    this.pan = { scale, x: (width - (right + left) * scale) / 2, y: (height - (bottom + top) * scale) / 2 };
    this.apply_pan();
  }

  // Robots that are equal but for their number are one, or are shown one by one again.
  fold(): void {
    settings.folded = !settings.folded;
    keep();
    this.has_panned = false;
    this.build();
  }

  private show_all(): void {
    this.has_panned = false;
    this.fit();
  }

  arrange(): void {
    for (const path of this.shapes.keys()) delete settings.positions[path];
    keep();
    this.has_panned = false;
    this.build();
  }

  // As a profile has them, by paths below the naming service; a component that has another host now is known by its name.
  place_all(positions: { [path: string]: number[] }): void {
    const places = Object.entries(positions);
    const last = (path: string) => path.slice(path.lastIndexOf('/') + 1);
    for (const { path } of store.system.components) {
      const same = places.filter(([saved]) => last(saved) === last(path));
      const [, place] = same.find(([saved]) => path.endsWith(`/${saved}`)) ?? (same.length === 1 ? same[0] : []);
      if (place) settings.positions[path] = [place[0], place[1]];
    }
    keep();
    this.has_panned = false;
    this.redraw();
  }

  positions(): { [path: string]: number[] } {
    this.redraw.now();
    const out: { [path: string]: number[] } = {};
    for (const [path, shape] of this.shapes) {
      const { x, y } = this.places.get(path)!;
      out[path] = [x, y, shape.width, shape.height].map(Math.round);
    }
    return out;
  }

  private zoom(factor: number, x: number, y: number): void {
    const scale = Math.min(3, Math.max(0.03, this.pan.scale * factor));
    const change = scale / this.pan.scale;
    this.pan = { scale, x: x - (x - this.pan.x) * change, y: y - (y - this.pan.y) * change };
    this.has_panned = true;
    this.apply_pan();
  }

  reveal(path: string): void {
    const place = this.places.get(path), shape = this.shapes.get(path);
    if (!place || !shape) return;
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width < 10 || height < 10) return; // it is not seen
    const x = place.x * this.pan.scale + this.pan.x, y = place.y * this.pan.scale + this.pan.y;
    if (x > 0 && y > 0 && x + shape.width * this.pan.scale < width && y + shape.height * this.pan.scale < height) return;
    this.has_panned = true;
    this.pan.x = width / 2 - (place.x + shape.width / 2) * this.pan.scale;
    this.pan.y = height / 2 - (place.y + shape.height / 2) * this.pan.scale;
    this.apply_pan();
  }

  // ---- mouse ----

  private on_plane(event: MouseEvent): Place {
    const box = this.canvas.getBoundingClientRect();
    return { x: (event.clientX - box.left - this.pan.x) / this.pan.scale, y: (event.clientY - box.top - this.pan.y) / this.pan.scale };
  }

  private listen(): void {
    let drag: { what: 'pan' | 'box' | 'port'; path: string; edge: string; x: number; y: number; moved: boolean } | null = null;
    const target_of = (event: Event, attribute: string) => (event.target as Element).closest?.(`[${attribute}]`)?.getAttribute(attribute) ?? '';
    this.canvas.addEventListener('pointerdown', (event) => {
      if (event.button > 1) return;
      const port = target_of(event, 'data-port'), path = target_of(event, 'data-path'), edge = target_of(event, 'data-connection');
      if (port) select({ kind: 'port', id: port });
      else if (path) select({ kind: 'component', id: path });
      else if (edge) select({ kind: 'connection', id: edge });
      drag = { what: port && !read_only() ? 'port' : path ? 'box' : 'pan', path: port || path, edge, x: event.clientX, y: event.clientY, moved: false };
      this.canvas.setPointerCapture(event.pointerId);
      this.canvas.focus({ preventScroll: true });
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (!drag) return;
      const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
      if (!drag.moved && Math.hypot(dx, dy) < 4) return;
      drag.moved = true;
      if (drag.what === 'port') return this.stretch(drag.path, event);
      [drag.x, drag.y] = [event.clientX, event.clientY];
      if (drag.what === 'pan') {
        this.has_panned = true;
        return this.slide(dx, dy);
      }
      const place = this.places.get(drag.path)!;
      place.x += dx / this.pan.scale;
      place.y += dy / this.pan.scale;
      this.move_box(drag.path);
      for (const [id, { connection }] of this.edges) if (connection.ports.some((p) => component_of_port(p) === drag!.path)) this.lead_line(id);
    });
    const end = (event: PointerEvent) => {
      const last = drag;
      drag = null;
      if (!last) return;
      if (last.what === 'pan' && last.moved) this.apply_pan();
      // Where the finger went down counts: with it captured, this event is of the canvas.
      if (last.what === 'pan' && !last.moved && !last.edge) select(null);
      if (last.what === 'box' && last.moved) {
        this.has_panned = true;
        // All of them: what was arranged around it stays where it is.
        for (const [path, { x, y }] of this.places) if (this.shapes.has(path)) settings.positions[path] = [Math.round(x), Math.round(y)];
        keep();
      }
      if (last.what === 'port') this.drop(last.path, event);
    };
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
    this.canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const box = this.canvas.getBoundingClientRect();
      this.zoom(Math.exp(-Math.max(-200, Math.min(200, event.deltaY)) * 0.0015), event.clientX - box.left, event.clientY - box.top);
    }, { passive: false });
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    this.canvas.addEventListener('contextmenu', (event) => this.offer(event, target_of));
  }

  // Of what is under the mouse; by the keyboard of what is selected.
  private offer(event: MouseEvent, target_of: (event: Event, attribute: string) => string): void {
    const now = event.target === this.canvas && event.button !== 2 ? store.selection : null;
    const chosen = (kind: string) => (now?.kind === kind ? now.id : '');
    const port = target_of(event, 'data-port') || chosen('port'), path = target_of(event, 'data-path') || chosen('component'), edge = target_of(event, 'data-connection') || chosen('connection');
    if (port) port_menu(event, port, this.plot);
    else if (path) component_menu(event, path);
    else if (edge) wire_menu(event, edge, this.plot);
    else event.preventDefault();
  }

  private stretch(port: string, event: PointerEvent): void {
    const from = this.at(port);
    if (!from) return;
    const to = this.on_plane(event);
    this.ghost.setAttribute('d', from.kind === 'in' ? curve({ ...to, kind: 'out' }, from) : curve(from, { ...to, kind: 'in' }));
    const goal = port_under(event);
    for (const { ports, component: one } of this.shapes.values()) {
      for (const [name, spot] of ports) {
        const path = `${one.path}:${name}`;
        spot.element.classList.toggle('fits', fits(port, path));
        spot.element.classList.toggle('goal', path === goal && fits(port, path));
      }
    }
  }

  private drop(port: string, event: PointerEvent): void {
    this.ghost.setAttribute('d', '');
    for (const { ports } of this.shapes.values()) for (const spot of ports.values()) spot.element.classList.remove('fits', 'goal');
    const goal = port_under(event);
    if (goal && goal !== port) connect_dialog(port, goal);
  }

  // ---- keys ----

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    this.redraw.now();
    const arrows: { [key: string]: [number, number] } = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const now = store.selection;
    const path = now?.kind === 'component' ? now.id : now?.kind === 'port' ? component_of_port(now.id) : '';
    if (arrows[event.key]) this.go(path, arrows[event.key]);
    else if ((event.key === '[' || event.key === ']') && path) this.next_port(path, event.key === ']' ? 1 : -1);
    else if (event.key === 'c' && now?.kind === 'port' && !read_only()) connect_dialog(now.id);
    else if (event.key === '+' || event.key === '-') this.zoom(event.key === '+' ? 1.2 : 1 / 1.2, this.element.clientWidth / 2, this.element.clientHeight / 2);
    else if (event.key === '0') this.show_all();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private go(path: string, [dx, dy]: [number, number]): void {
    const middle = (p: string) => ({ x: this.places.get(p)!.x + this.shapes.get(p)!.width / 2, y: this.places.get(p)!.y + this.shapes.get(p)!.height / 2 });
    let best = '', cost = Infinity;
    if (!path || !this.shapes.has(path)) best = this.shapes.keys().next().value ?? '';
    else {
      const from = middle(path);
      for (const other of this.shapes.keys()) {
        if (other === path) continue;
        const to = middle(other);
        const along = (to.x - from.x) * dx + (to.y - from.y) * dy, across = Math.abs((to.x - from.x) * dy) + Math.abs((to.y - from.y) * dx);
        if (along > 1 && along + 2.5 * across < cost) [best, cost] = [other, along + 2.5 * across];
      }
    }
    if (!best) return;
    select({ kind: 'component', id: best });
    this.reveal(best);
  }

  private next_port(path: string, way: number): void {
    const ports = this.shapes.get(path)?.component.ports ?? [];
    if (ports.length === 0) return;
    const now = store.selection?.kind === 'port' ? ports.findIndex((p) => p.name === name_of_port(store.selection!.id)) : way > 0 ? -1 : 0;
    select({ kind: 'port', id: `${path}:${ports[(now + way + ports.length) % ports.length].name}` });
  }

  tools(): HTMLElement[] {
    return [
      button('Show the whole system', { icon: 'whole', key: '0' }, () => this.show_all()),
      button('Arrange automatically', { icon: 'arrange' }, () => this.arrange()),
      button('Fold equal robots', { icon: 'fold', pressed: settings.folded }, (event) => {
        this.fold();
        (event.currentTarget as Element).setAttribute('aria-pressed', String(settings.folded));
      }),
    ];
  }
}

function port_under(event: PointerEvent): string {
  return document.elementFromPoint(event.clientX, event.clientY)?.closest('[data-port]')?.getAttribute('data-port') ?? '';
}

// Only what can be seen from here; the server knows better.
export function fits(a: string, b: string): boolean {
  const first = port_of(a), second = port_of(b);
  if (!first || !second || a === b) return false;
  if (first.kind === 'service' || second.kind === 'service') return first.kind === second.kind;
  return first.kind !== second.kind && first.data_type === second.data_type;
}
