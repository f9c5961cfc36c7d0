// Everything by name: robots with their ifaces, components with their ports, managers, signals. One search for all.
import { h, icon, once_a_frame, put, unless_pressed } from './dom';
import { state_mark, state_words } from './states';
import { changed, iface_id, is_selected, on, select, Selection, selected_model, shown_state, store, wire, components_of } from './store';

interface Row { key: string; label: string; more?: string; selection?: Selection; children?: () => Row[]; mark?: () => Element | null; hint?: string; topic?: string; related?: boolean; closed?: boolean }

const max_rows = 800;
const icon_of: { [kind: string]: string } = { model: 'world', component: 'system', port: 'link', manager: 'inspect', signal: 'plot', iface: 'laser' };

export class Tree {
  readonly element = h('div', { class: 'tree' });
  readonly search = h('input', { type: 'search', placeholder: 'Search', 'aria-label': 'Search robots, components and signals', title: 'Search (/)' });
  private readonly list = h('ul', { role: 'tree', 'aria-label': 'Robots, components, signals' });
  private open = new Map<string, boolean>();
  private rows: { row: Row; level: number; parent: string; element: HTMLElement; is_open: boolean; has_children: boolean }[] = [];
  private focus_key = '';
  private refresh = once_a_frame(() => unless_pressed(this.list, () => this.build()));

  constructor() {
    this.element.append(h('div', { class: 'search grip-place' }, this.search), this.list);
    on(['system', 'world', 'signals', 'selection', 'details', 'states', 'status'], this.refresh);
    this.search.addEventListener('input', this.refresh);
    this.search.addEventListener('keydown', (event) => {
      if (event.key !== 'ArrowDown' && event.key !== 'Enter') return;
      this.refresh.now();
      (this.rows.find((r) => r.row.selection)?.element ?? this.rows[0]?.element)?.focus();
      event.preventDefault();
    });
    this.list.addEventListener('keydown', (event) => this.key(event));
  }

  private roots(): Row[] {
    const { world, system, signals } = store;
    const robots = world?.models.filter((m) => world.ifaces.some((i) => i.model === m.name && i.type !== 'truth')) ?? [];
    const names = new Set(robots.map((m) => m.name));
    const others = world?.models.filter((m) => !names.has(m.name)) ?? [];
    const model = (m: { name: string; static: boolean }): Row => ({
      key: `model:${m.name}`, label: m.name, selection: { kind: 'model', id: m.name }, closed: true,
      children: () => (world?.ifaces ?? []).filter((i) => i.model === m.name && i.type !== 'truth').map((i) => ({
        key: `iface:${iface_id(i)}`, label: i.name.startsWith(`${m.name}::`) ? i.name.slice(m.name.length + 2) : i.name, more: i.type, selection: { kind: 'iface', id: iface_id(i) },
      })),
    });
    const model_now = selected_model();
    const related = new Set(model_now ? components_of(model_now) : []);
    return [
      { key: 'robots', label: 'Robots', more: String(robots.length), children: () => robots.map(model) },
      { key: 'things', label: 'Static models', more: String(others.length), closed: true, children: () => others.map(model) },
      {
        key: 'components', label: 'Components', more: String(system.components.length), children: () => system.components.map((c) => ({
          key: `component:${c.path}`, label: c.instance, more: c.type === c.instance.replace(/\d+$/, '') ? '' : c.type, hint: `${c.instance} is ${state_words[shown_state(c)]}`, selection: { kind: 'component', id: c.path },
          closed: true, related: related.has(c.path), mark: () => state_mark(shown_state(c)),
          children: () => c.ports.map((p) => ({
            key: `port:${c.path}:${p.name}`, label: p.name, more: { in: 'in', out: 'out', service: 'service' }[p.kind], selection: { kind: 'port', id: `${c.path}:${p.name}` },
          })),
        })),
      },
      { key: 'managers', label: 'Managers', more: String(system.managers.length), closed: true, children: () => system.managers.map((m) => ({ key: `manager:${m.path}`, label: short_path(m.path), hint: m.path, more: m.problem ? 'problem' : '', selection: { kind: 'manager', id: m.path } })) },
      {
        key: 'signals', label: 'Signals', more: String(signals.length), children: () => signals.map((s) => ({
          key: `signal:${s.topic}`, label: signal_name(s), more: s.kind === 'iface' ? s.type : s.kind, hint: `${s.topic}: ${s.type}. Drag it into the plots.`, topic: s.topic, selection: { kind: 'signal', id: s.topic }, related: Boolean(model_now && s.model === model_now),
        })),
      },
    ];
  }

  private build(): void {
    const had_focus = this.list.contains(document.activeElement);
    const query = this.search.value.trim().toLowerCase();
    this.rows = [];
    const elements: HTMLElement[] = [];
    let left_out = 0;
    const matches = (row: Row): boolean => !query || (row.selection !== undefined && (row.label.toLowerCase().includes(query) || (row.more ?? '').toLowerCase().includes(query))) || (row.children?.().some(matches) ?? false);
    const visit = (row: Row, level: number, parent: string) => {
      if (query && !matches(row)) return;
      if (this.rows.length >= max_rows) return void ++left_out;
      const children = row.children?.() ?? [];
      const is_open = query ? children.some(matches) : this.open.get(row.key) ?? !row.closed;
      const element = this.row(row, level, children.length > 0 ? is_open : undefined);
      this.rows.push({ row, level, parent, element, is_open, has_children: children.length > 0 });
      elements.push(element);
      if (is_open) for (const child of children) visit(child, level + 1, row.key);
    };
    for (const root of this.roots()) visit(root, 0, '');
    if (left_out > 0) elements.push(h('li', { class: 'more', role: 'none' }, `${left_out} more: search for them`));
    if (query && this.rows.length === 0) elements.push(h('li', { class: 'more', role: 'none' }, `Nothing is called “${query}”`));
    if (wire.status !== 'open') elements.unshift(h('li', { class: 'more', role: 'none' }, 'Not connected: as last seen'));
    const scroll = this.list.scrollTop;
    put(this.list, elements);
    this.list.scrollTop = scroll;
    const now = this.rows.find((r) => r.row.key === this.focus_key) ?? this.rows[0];
    if (now) {
      now.element.tabIndex = 0;
      if (had_focus) now.element.focus({ preventScroll: true });
    }
  }

  private row(row: Row, level: number, is_open: boolean | undefined): HTMLElement {
    const chosen = row.selection ? is_selected(row.selection.kind, row.selection.id) : false;
    const mark = row.mark?.() ?? (row.selection ? icon(icon_of[row.selection.kind]) : null);
    const twist = h('span', { class: 'twist', 'aria-hidden': 'true' }, is_open === undefined ? '' : is_open ? '▾' : '▸');
    const element = h('li', {
      role: 'treeitem', tabindex: -1, 'aria-level': level + 1, 'aria-expanded': is_open === undefined ? undefined : String(is_open), 'aria-selected': String(chosen), 'data-key': row.key, title: row.hint ?? row.label,
      class: `${level === 0 ? 'group' : ''}${chosen ? ' chosen' : ''}${row.related ? ' related' : ''}`, draggable: row.topic ? 'true' : undefined,
    }, twist, mark, h('span', { class: 'label' }, row.label), row.more ? h('span', { class: 'more' }, row.more) : null);
    element.style.paddingLeft = `${4 + level * 14}px`;
    element.addEventListener('click', (event) => {
      this.focus_key = row.key;
      if (!row.selection || (event.target as Element).closest('.twist')) this.toggle(row.key, is_open);
      if (row.selection) select(row.selection);
    });
    element.addEventListener('focus', () => { this.focus_key = row.key; });
    if (row.topic) element.addEventListener('dragstart', (event) => event.dataTransfer?.setData('text/plain', row.topic!));
    return element;
  }

  private toggle(key: string, is_open: boolean | undefined): void {
    if (is_open === undefined) return;
    this.open.set(key, !is_open);
    this.build();
  }

  private key(event: KeyboardEvent): void {
    const at = this.rows.findIndex((r) => r.element === document.activeElement);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const now = this.rows[at];
    const go = (to: number) => this.rows[Math.min(this.rows.length - 1, Math.max(0, to))].element.focus();
    if (event.key === 'ArrowDown') go(at + 1);
    else if (event.key === 'ArrowUp') go(at - 1);
    else if (event.key === 'Home') go(0);
    else if (event.key === 'End') go(this.rows.length - 1);
    else if (event.key === 'ArrowRight' && now.has_children) now.is_open ? go(at + 1) : this.toggle(now.row.key, false);
    else if (event.key === 'ArrowLeft') now.has_children && now.is_open ? this.toggle(now.row.key, true) : go(this.rows.findIndex((r) => r.row.key === now.parent));
    else if (event.key === 'Enter') {
      this.focus_key = now.row.key;
      if (now.row.selection) select(now.row.selection);
      else this.toggle(now.row.key, now.is_open);
      if (now.row.topic) changed('plots');
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

// Without what the kind says already.
export const signal_name = (signal: { topic: string; kind: string }): string => signal.topic.replace(/^\/sim\/[^/]+\//, '').replace(/^\//, '');

export const short_path = (path: string): string => path.split('/').pop()!.replace(/\.(rtc|mgr)$/, '');
