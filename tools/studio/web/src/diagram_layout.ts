// Where boxes of components stand: layers from left to right along the connections, loops broken where they are met; those without
// connections in rows below.
export interface Box { path: string; width: number; height: number }
export interface Place { x: number; y: number }

const gap_x = 48, gap_y = 26;

export function arrange(boxes: Box[], edges: [string, string][]): Map<string, Place> {
  const places = new Map<string, Place>();
  const next = new Map<string, Set<string>>(), before = new Map<string, Set<string>>();
  for (const { path } of boxes) {
    next.set(path, new Set());
    before.set(path, new Set());
  }
  for (const [from, to] of edges) {
    if (from === to || !next.has(from) || !next.has(to)) continue;
    next.get(from)!.add(to);
    before.get(to)!.add(from);
  }
  const wired = boxes.filter((b) => next.get(b.path)!.size + before.get(b.path)!.size > 0);
  let below = 0;
  for (const part of parts_of(wired, next, before)) below = place_part(part, next, before, below, places) + 2 * gap_y;
  place_rest(boxes.filter((b) => !places.has(b.path)), below, places);
  return places;
}

function parts_of(boxes: Box[], next: Map<string, Set<string>>, before: Map<string, Set<string>>): Box[][] {
  const by_path = new Map(boxes.map((b) => [b.path, b]));
  const seen = new Set<string>();
  const parts: Box[][] = [];
  for (const box of boxes) {
    if (seen.has(box.path)) continue;
    const part: Box[] = [];
    const stack = [box.path];
    seen.add(box.path);
    while (stack.length > 0) {
      const path = stack.pop()!;
      part.push(by_path.get(path)!);
      for (const other of [...next.get(path)!, ...before.get(path)!]) {
        if (seen.has(other)) continue;
        seen.add(other);
        stack.push(other);
      }
    }
    parts.push(part.sort((a, b) => boxes.indexOf(a) - boxes.indexOf(b)));
  }
  return parts.sort((a, b) => b.length - a.length);
}

// The longest way to each box; an edge that closes a loop does not count.
function layers_of(part: Box[], next: Map<string, Set<string>>, before: Map<string, Set<string>>): Map<string, number> {
  const layer = new Map<string, number>();
  const open = new Set<string>(), done = new Set<string>();
  const forward = new Map<string, string[]>();
  const visit = (path: string) => {
    open.add(path);
    for (const to of next.get(path)!) {
      if (open.has(to)) continue;
      if (!forward.has(path)) forward.set(path, []);
      forward.get(path)!.push(to);
      if (!done.has(to)) visit(to);
    }
    open.delete(path);
    done.add(path);
    order.push(path);
  };
  const order: string[] = [];
  const sources = [...part].sort((a, b) => before.get(a.path)!.size - before.get(b.path)!.size);
  for (const { path } of sources) if (!done.has(path)) visit(path);
  for (const path of order.reverse()) {
    layer.set(path, layer.get(path) ?? 0);
    for (const to of forward.get(path) ?? []) layer.set(to, Math.max(layer.get(to) ?? 0, layer.get(path)! + 1));
  }
  return layer;
}

function place_part(part: Box[], next: Map<string, Set<string>>, before: Map<string, Set<string>>, top: number, places: Map<string, Place>): number {
  const layer = layers_of(part, next, before);
  const columns: Box[][] = [];
  for (const box of part) (columns[layer.get(box.path)!] ??= []).push(box);
  const rank = new Map<string, number>();
  columns.forEach((column) => column.forEach((box, i) => rank.set(box.path, i)));
  for (let round = 0; round < 6; ++round) {
    for (const column of round % 2 === 0 ? columns : [...columns].reverse()) {
      const weight = new Map(column.map((box) => {
        const near = [...before.get(box.path)!, ...next.get(box.path)!];
        return [box.path, near.reduce((sum, path) => sum + (rank.get(path) ?? 0), 0) / Math.max(1, near.length)];
      }));
      column.sort((a, b) => weight.get(a.path)! - weight.get(b.path)!);
      column.forEach((box, i) => rank.set(box.path, i));
    }
  }
  const height_of = (column: Box[]) => column.reduce((sum, box) => sum + box.height + gap_y, -gap_y);
  const tallest = Math.max(...columns.map(height_of));
  let x = 0;
  for (const column of columns) {
    let y = top + (tallest - height_of(column)) / 2;
    for (const box of column) {
      places.set(box.path, { x, y });
      y += box.height + gap_y;
    }
    x += Math.max(...column.map((box) => box.width)) + gap_x;
  }
  return top + tallest;
}

function place_rest(rest: Box[], top: number, places: Map<string, Place>): void {
  const columns = Math.max(3, Math.ceil(Math.sqrt(rest.length * 0.8)));
  let x = 0, y = top, tallest = 0;
  rest.forEach((box, i) => {
    if (i > 0 && i % columns === 0) {
      x = 0;
      y += tallest + gap_y;
      tallest = 0;
    }
    places.set(box.path, { x, y });
    x += box.width + gap_y;
    tallest = Math.max(tallest, box.height);
  });
}
