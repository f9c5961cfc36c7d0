// Where panels are: rows and columns of places, each with one panel, or with several as tabs. Values; they are kept by the browser and in links.
export type Panel = 'tree' | 'world' | 'system' | 'inspector' | 'bottom';
export type Side = 'left' | 'right' | 'top' | 'bottom' | 'middle';
export interface Leaf { panels: Panel[]; shown: Panel; size: number }
// `size`, of all: pixels from 2 on, below it a share of what is left.
export interface Split { way: 'x' | 'y'; parts: Node[]; size: number }
export type Node = Leaf | Split;

export const all_panels: Panel[] = ['tree', 'world', 'system', 'inspector', 'bottom'];
const leaf = (panel: Panel, size: number): Leaf => ({ panels: [panel], shown: panel, size });

export const usual_layout = (): Split => ({
  way: 'y', size: 1, parts: [
    { way: 'x', size: 1, parts: [leaf('tree', 230), { way: 'x', size: 1, parts: [leaf('world', 0.55), leaf('system', 0.45)] }, leaf('inspector', 300)] },
    leaf('bottom', 220)],
});

export const is_split = (node: Node): node is Split => 'way' in node;
export const leaves = (node: Node): Leaf[] => (is_split(node) ? node.parts.flatMap(leaves) : [node]);
export const leaf_of = (root: Node, panel: Panel): Leaf | undefined => leaves(root).find((l) => l.panels.includes(panel));

// What a link or the browser holds may be anything.
export function checked(root: unknown): Split {
  try {
    const good = (node: any, depth: number): boolean => depth < 8 && Number.isFinite(node.size) && node.size > 0 && (is_split(node)
      ? (node.way === 'x' || node.way === 'y') && node.parts.length > 0 && node.parts.every((part: unknown) => good(part, depth + 1))
      : Array.isArray(node.panels) && node.panels.length > 0 && node.panels.includes(node.shown));
    const node = root as Node;
    if (is_split(node) && good(node, 0) && leaves(node).flatMap((l) => l.panels).sort().join() === [...all_panels].sort().join()) return structuredClone(node);
  } catch { /* not a layout */ }
  return usual_layout();
}

// Without splits of one part, or in one of the same way with its sizes.
function tidy(node: Node): Node | null {
  if (!is_split(node)) return node.panels.length > 0 ? node : null;
  const parts = node.parts.map(tidy).filter((part): part is Node => part !== null);
  if (parts.length === 0) return null;
  if (parts.length === 1) return { ...parts[0], size: node.size };
  return { ...node, parts };
}

// Takes the panel out and puts it beside, above or below the place of `target`, or into it as a tab; without a target beside everything.
export function moved(root: Split, panel: Panel, target: Panel | null, side: Side): Split {
  const copy = structuredClone(root);
  if (target === panel && leaf_of(copy, panel)!.panels.length === 1) return copy;
  const from = leaf_of(copy, panel)!;
  from.panels = from.panels.filter((p) => p !== panel);
  if (from.shown === panel && from.panels.length > 0) from.shown = from.panels[0];
  const at = target === panel ? from : target ? leaf_of(copy, target)! : null;
  if (at && side === 'middle') {
    at.panels.push(panel);
    at.shown = panel;
    return whole(tidy(copy)!);
  }
  const way = side === 'left' || side === 'right' ? 'x' : 'y', is_first = side === 'left' || side === 'top';
  const one = leaf(panel, 0.5);
  if (!at) {
    const rest = tidy(copy)!;
    one.size = way === 'x' ? 280 : 220;
    rest.size = 1;
    return { way, size: 1, parts: is_first ? [one, rest] : [rest, one] };
  }
  const old: Leaf = { ...at, size: 0.5 };
  const split: Split = { way, size: at.size, parts: is_first ? [one, old] : [old, one] };
  const put = (node: Node): Node => (node === at ? split : is_split(node) ? { ...node, parts: node.parts.map(put) } : node);
  return whole(tidy(put(copy))!);
}

const whole = (node: Node): Split => (is_split(node) ? node : { way: 'x', size: 1, parts: [{ ...node, size: 1 }] });
