// Puts the panels where the layout says, with handles between them to size them, grips to move them, and tabs where several share a place.
// On narrow screens one panel at a time, and time below it.
import { button, h, put } from './dom';
import { all_panels, checked, is_split, leaf_of, leaves, type Leaf, moved, type Node, type Panel, type Side, type Split, usual_layout } from './layout';
import { open_menu } from './menu';
import { keep, settings } from './settings';

export const panel_names: { [panel in Panel]: string } = { tree: 'Tree', world: 'World', system: 'System', inspector: 'Inspector', bottom: 'Time and plots' };
const folded = 33; // [px] of time when only its buttons are shown

export class Dock {
  readonly element = h('main', { class: 'work' });
  readonly narrow = matchMedia('(max-width: 760px)');
  only: Panel = 'world'; // on narrow screens
  private readonly drop = h('div', { class: 'drop', hidden: true });
  private readonly attic = h('div', { hidden: true }); // panels that are not shown stay in the page
  private boxes = new Map<Node, HTMLElement>();
  private built = '';

  constructor(private readonly elements: { [panel in Panel]: HTMLElement }) {
    settings.layout = { root: checked(settings.layout.root) };
    for (const panel of all_panels) this.add_grip(panel);
    document.body.append(this.drop);
    this.narrow.addEventListener('change', () => this.lay_out());
  }

  private get root(): Split {
    return settings.layout.root as Split;
  }
  set(root: Split): void {
    settings.layout = { root: checked(root) };
    this.built = '';
    this.lay_out();
    keep();
  }
  move(panel: Panel, target: Panel | null, side: Side): void {
    settings.panels[panel] = true;
    this.set(moved(this.root, panel, target, side));
  }
  // Brings a panel that is behind another as a tab to the front.
  raise(panel: Panel): void {
    const leaf = leaf_of(this.root, panel)!;
    if (leaf.shown === panel) return;
    leaf.shown = panel;
    this.built = '';
    this.lay_out();
  }
  is_front(panel: Panel): boolean {
    return settings.panels[panel] && leaf_of(this.root, panel)?.shown === panel;
  }
  // In pixels, along the way of what it is in.
  resize(panel: Panel, size: number): void {
    leaf_of(this.root, panel)!.size = size;
    this.show_sizes();
  }

  lay_out(): void {
    for (const leaf of leaves(this.root)) if (!settings.panels[leaf.shown]) leaf.shown = leaf.panels.find((p) => settings.panels[p]) ?? leaf.shown;
    const { only } = this;
    const root: Node = !this.narrow.matches ? this.root : { way: 'y', size: 1, parts: [only, 'bottom' as Panel].filter((p, i, all) => all.indexOf(p) === i).map((p) => ({ panels: [p], shown: p, size: p === only ? 1 : folded })) };
    const key = JSON.stringify([root, settings.panels, this.narrow.matches], (name, value) => (name === 'size' ? undefined : value));
    if (key !== this.built) {
      this.built = key;
      this.boxes.clear();
      const focused = document.activeElement as HTMLElement | null;
      const places = this.build(root);
      this.attic.replaceChildren(...all_panels.map((p) => this.elements[p]).filter((e) => !places.contains(e)));
      put(this.element, places, this.attic);
      if (focused?.isConnected) focused.focus({ preventScroll: true });
    }
    this.show_sizes();
  }

  private visible(node: Node): boolean {
    return leaves(node).some((leaf) => leaf.panels.some((p) => this.narrow.matches || settings.panels[p] || (p === 'bottom' && leaf.panels.length === 1)));
  }

  private build(node: Node): HTMLElement {
    const box = is_split(node) ? this.build_split(node) : this.build_leaf(node);
    this.boxes.set(node, box);
    return box;
  }

  private build_split(node: Split): HTMLElement {
    const shown = node.parts.filter((part) => this.visible(part));
    return h('div', { class: `split ${node.way}` }, shown.map((part, i) => [i > 0 && !this.narrow.matches ? this.splitter(node, shown[i - 1], part) : null, this.build(part)]));
  }

  private build_leaf(leaf: Leaf): HTMLElement {
    const panels = this.narrow.matches ? leaf.panels : leaf.panels.filter((p) => settings.panels[p] || leaf.panels.length === 1);
    const is_folded = leaf.shown === 'bottom' && (this.narrow.matches ? this.only !== 'bottom' : !settings.panels.bottom);
    this.elements.bottom.classList.toggle('folded', leaf.panels.includes('bottom') ? is_folded : this.elements.bottom.classList.contains('folded'));
    const tabs = panels.length < 2 ? null : h('div', { class: 'leaf-tabs', role: 'tablist', 'aria-label': 'Panels of this place' }, panels.map((panel) => h('button', {
      type: 'button', role: 'tab', 'data-panel': panel, 'aria-selected': String(panel === leaf.shown), tabindex: panel === leaf.shown ? 0 : -1, onclick: () => { this.raise(panel); keep(); },
      onkeydown: (event: KeyboardEvent) => {
        const way = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
        if (way === 0) return;
        const next = panels[(panels.indexOf(panel) + way + panels.length) % panels.length];
        this.raise(next);
        this.element.querySelector<HTMLElement>(`.leaf-tabs [data-panel=${next}]`)?.focus();
        event.stopPropagation();
      },
    }, panel_names[panel])));
    return h('div', { class: 'leaf', 'data-leaf': leaf.shown }, tabs, this.elements[leaf.shown]);
  }

  // ---- sizes ----

  private show_sizes(): void {
    const show = (node: Split) => {
      const parts = node.parts.filter((part) => this.boxes.has(part)), has_rest = parts.some((part) => part.size < 2);
      for (const part of parts) {
        const box = this.boxes.get(part)!;
        const is_folded = !is_split(part) && part.shown === 'bottom' && this.elements.bottom.classList.contains('folded');
        box.style.flex = is_folded ? `0 0 ${folded}px` : part.size < 2 ? `${part.size * 1000} 1 0px` : has_rest ? `0 1 ${part.size}px` : `${part.size} 1 0px`;
        if (is_split(part)) show(part);
      }
    };
    for (const node of this.boxes.keys()) if (is_split(node)) show(node);
    this.element.querySelectorAll<HTMLElement>('.splitter').forEach((handle) => {
      const [before, all] = [handle.previousElementSibling!, handle.parentElement!].map((e) => (handle.classList.contains('x') ? (e as HTMLElement).clientWidth : (e as HTMLElement).clientHeight));
      handle.setAttribute('aria-valuenow', String(Math.round((100 * before) / Math.max(1, all))));
    });
  }

  private splitter(split: Split, before: Node, after: Node): HTMLElement {
    const axis = split.way, sized = before.size >= 2 ? before : after.size >= 2 ? after : null;
    const name = leaves(sized ?? before).map((l) => panel_names[l.shown]).join(', '), of = leaves(sized ?? before).map((l) => `of-${l.shown}`).join(' ');
    const handle = h('div', { class: `splitter ${axis} ${sized ? of : 'of-split'}`, role: 'separator', tabindex: 0, 'aria-orientation': axis === 'x' ? 'vertical' : 'horizontal', 'aria-label': `Size: ${name}`, 'aria-valuenow': 50, 'aria-valuemin': 0, 'aria-valuemax': 100 });
    const length = (node: Node) => { const box = this.boxes.get(node)!; return axis === 'x' ? box.clientWidth : box.clientHeight; };
    const change = (by: number) => {
      const [a, b] = [length(before), length(after)], least = 90;
      const step = Math.max(Math.min(0, least - a), Math.min(Math.max(0, b - least), by));
      if (sized) sized.size = Math.max(40, length(sized) + (sized === before ? step : -step));
      else {
        const both = before.size + after.size, share = (a + step) / Math.max(1, a + b);
        [before.size, after.size] = [both * share, both * (1 - share)];
      }
      this.show_sizes();
      keep();
    };
    let last = 0;
    handle.addEventListener('pointerdown', (event) => {
      last = axis === 'x' ? event.clientX : event.clientY;
      handle.setPointerCapture(event.pointerId);
    });
    handle.addEventListener('pointermove', (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const now = axis === 'x' ? event.clientX : event.clientY;
      change(now - last);
      last = now;
    });
    handle.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -20, ArrowUp: -20, ArrowRight: 20, ArrowDown: 20 }[event.key];
      if (by === undefined) return;
      change(by);
      event.preventDefault();
      event.stopPropagation();
    });
    return handle;
  }

  // ---- moving ----

  private add_grip(panel: Panel): void {
    const grip = button(`Move the panel ${panel_names[panel]}`, { icon: 'grip', class: 'plain small grip' }, (event) => { if (event.detail === 0 || !has_moved) this.offer(event, panel); });
    let has_moved = false;
    grip.addEventListener('pointerdown', (event) => {
      has_moved = false;
      grip.setPointerCapture(event.pointerId);
    });
    grip.addEventListener('pointermove', (event) => {
      if (!grip.hasPointerCapture(event.pointerId)) return;
      has_moved = has_moved || Math.hypot(event.movementX, event.movementY) > 1;
      if (has_moved) this.show_drop(event);
    });
    const end = (event: PointerEvent) => {
      const place = has_moved && event.type === 'pointerup' ? this.place_under(event) : null;
      this.drop.hidden = true;
      if (place) this.move(panel, place.target, place.side);
    };
    grip.addEventListener('pointerup', end);
    grip.addEventListener('pointercancel', end);
    this.elements[panel].querySelector('.grip-place')!.prepend(grip);
  }

  // Near an edge of a place beside it, in its middle as a tab; at the very edge of the page beside everything.
  private place_under(event: PointerEvent): { target: Panel | null; side: Side; box: DOMRect } | null {
    const all = this.element.getBoundingClientRect();
    const near = (box: DOMRect, reach: (length: number) => number): Side => {
      const [left, top, right, bottom] = [event.clientX - box.left, event.clientY - box.top, box.right - event.clientX, box.bottom - event.clientY];
      if (Math.min(left, right) / reach(box.width) > 1 && Math.min(top, bottom) / reach(box.height) > 1) return 'middle';
      const least = Math.min(left / box.width, right / box.width, top / box.height, bottom / box.height);
      return least === left / box.width ? 'left' : least === right / box.width ? 'right' : least === top / box.height ? 'top' : 'bottom';
    };
    const edge = near(all, () => 14);
    if (edge !== 'middle') return { target: null, side: edge, box: all };
    const leaf = document.elementsFromPoint(event.clientX, event.clientY).map((e) => e.closest<HTMLElement>('.leaf')).find((e) => e);
    if (!leaf) return null;
    const box = leaf.getBoundingClientRect();
    return { target: leaf.dataset.leaf as Panel, side: near(box, (length) => length * 0.28), box };
  }

  private show_drop(event: PointerEvent): void {
    const place = this.place_under(event);
    this.drop.hidden = place === null;
    if (!place) return;
    const { side, box, target } = place, share = target ? 0.5 : 0.2;
    const width = side === 'left' || side === 'right' ? box.width * share : box.width, height = side === 'top' || side === 'bottom' ? box.height * share : box.height;
    Object.assign(this.drop.style, { left: `${side === 'right' ? box.right - width : box.left}px`, top: `${side === 'bottom' ? box.bottom - height : box.top}px`, width: `${width}px`, height: `${height}px` });
  }

  private offer(event: MouseEvent, panel: Panel): void {
    const others = all_panels.filter((p) => p !== panel && settings.panels[p]);
    const sides: [Side, string][] = [['left', 'left'], ['right', 'right'], ['top', 'top'], ['bottom', 'bottom']];
    open_menu(event, `Panel ${panel_names[panel]}`, [
      ...sides.map(([side, word]) => ({ text: `To the ${word} edge`, act: () => this.move(panel, null, side) })),
      ...others.map((other) => ({ text: `As a tab of ${panel_names[other]}`, act: () => this.move(panel, other, 'middle') })),
      ...others.map((other) => ({ text: `Below ${panel_names[other]}`, act: () => this.move(panel, other, 'bottom') })),
    ]);
  }

  // ---- saved layouts ----

  offer_layouts(event: MouseEvent, ask_name: (save: (name: string) => void) => void): void {
    const names = Object.keys(settings.layouts).sort();
    open_menu(event, 'Layouts', [
      { text: 'Usual layout', act: () => { settings.panels = { tree: true, world: true, system: true, inspector: true, bottom: true }; this.set(usual_layout()); } },
      ...names.map((name) => ({ text: name, act: () => { settings.panels = { ...settings.panels, ...settings.layouts[name].panels }; this.set(checked(settings.layouts[name].root)); } })),
      { text: 'Save this layout …', act: () => ask_name((name) => { settings.layouts[name] = { root: structuredClone(this.root), panels: { ...settings.panels } }; keep(); }) },
      ...names.map((name) => ({ text: `Delete ${name}`, danger: true, act: () => { delete settings.layouts[name]; keep(); } })),
    ]);
  }
}
