// Signals over simulated time, a few lines a plot. Signals come by drag from the tree, by the inspector or by search. A drag over a plot or
// the wheel zooms all of them; the cursor shows values in the legends.
import uPlot from 'uplot';
import { button, h, put } from './dom';
import { download } from './download';
import { angle_unit, shown_value } from './angles';
import { flatten, iface_type } from './values';
import { recording } from './playback';
import { keep, settings } from './settings';
import { on, store, wire } from './store';
import { signal_name } from './tree';
import { watch } from './watches';
import { palette } from './palette';

interface Line { topic: string; kind: string; member: string; times: number[]; values: (number | null)[]; stop: () => void; error: string; at?: HTMLElement; other?: [number[], (number | null)[]] } // `other`: of the recording that is compared with
const max_points = 12000;
const recorded_points = 6000; // of a line, of all of a recording or of the part that is looked at

// Angles in degrees.
const number_of = ({ topic, member }: Line, value: unknown): number | null => (typeof value === 'number' ? shown_value(member, value, iface_type(topic)) as number : typeof value === 'boolean' ? Number(value) : null);
function name_of({ topic, member }: Line): string {
  const unit = angle_unit(member, iface_type(topic));
  return unit ? `${member} [${unit}]` : member;
}

class Plot {
  readonly element = h('div', { class: 'plot' });
  private readonly legend = h('div', { class: 'legend' });
  private readonly body = h('div', { class: 'body' });
  private lines: Line[] = [];
  private plot: uPlot | null = null;

  constructor(private readonly entry: { series: { topic: string; member: string }[] }, private readonly remove: () => void, private readonly choose: (time: number) => void, private readonly zoom: (range: [number, number] | null) => void) {
    this.element.append(this.legend, this.body);
    for (const { topic, member } of entry.series) this.begin(topic, member);
    this.element.addEventListener('dragover', (event) => event.preventDefault());
    this.element.addEventListener('drop', (event) => {
      event.preventDefault();
      event.stopPropagation();
      first_member(event.dataTransfer?.getData('text/plain') ?? '').then((line) => line && this.add(line.topic, line.member));
    });
    this.body.addEventListener('click', (event) => {
      const over = this.body.querySelector('.u-over')?.getBoundingClientRect();
      if (this.has_dragged) return;
      if (this.plot && over && event.clientX >= over.left && event.clientX <= over.right) this.choose(this.plot.posToVal(event.clientX - over.left, 'x'));
    });
    this.body.addEventListener('pointerdown', () => { this.has_dragged = false; }, true);
    this.body.addEventListener('dblclick', () => this.zoom(null));
    this.body.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    new ResizeObserver(() => this.make()).observe(this.body);
  }
  private has_dragged = false; // then the click chooses no moment

  // About the time under the mouse.
  private wheel(event: WheelEvent): void {
    const over = this.body.querySelector('.u-over')?.getBoundingClientRect(), { min, max } = this.plot?.scales.x ?? {};
    if (!over || min === undefined || max === undefined) return;
    event.preventDefault();
    const factor = Math.exp(Math.max(-200, Math.min(200, event.deltaY)) * 0.002), at = this.plot!.posToVal(event.clientX - over.left, 'x');
    this.zoom([at - (at - min!) * factor, at + (max! - at) * factor]);
  }

  has(topic: string, member: string): boolean {
    return this.lines.some((l) => l.topic === topic && l.member === member);
  }

  add(topic: string, member: string): void {
    if (this.has(topic, member)) return;
    this.entry.series.push({ topic, member });
    keep();
    this.begin(topic, member);
    this.make();
  }

  private begin(topic: string, member: string): void {
    const line: Line = { topic, kind: '', member, times: [], values: [], stop: () => {}, error: '' };
    this.lines.push(line);
    if (recording()) return void this.load(line);
    line.stop = watch({ topic, members: [member], hz: 30 }, (values) => {
      line.error = values.error ?? '';
      if (values.error || !values.t) return this.show_legend();
      values.t.forEach((time, i) => {
        const last = line.times[line.times.length - 1];
        if (last !== undefined && time < last) line.times.length = line.values.length = 0; // reset
        const value = values.v?.[i]?.[0];
        line.times.push(time);
        line.values.push(number_of(line, value));
      });
      if (line.times.length > max_points) {
        line.times.splice(0, 2000);
        line.values.splice(0, 2000);
      }
    });
    this.show_legend();
  }

  // All of it that is recorded; when that is much, so many samples of it as a plot can show.
  private async load(line: Line): Promise<void> {
    const whole = recording()!;
    this.show_legend();
    try {
      for (let from = whole.from; from < whole.to && this.lines.includes(line);) {
        const { result } = await wire.request('series', { topic: line.topic, members: [line.member], from, to: whole.to, points: recorded_points });
        line.times.push(...result.t);
        line.values.push(...result.v.map(([value]: [unknown]) => number_of(line, value)));
        line.error = result.left_out > 0 ? `(${result.t.length} of ${result.t.length + result.left_out} samples)` : '';
        if (!(result.until > from)) break;
        from = result.until >= whole.to ? whole.to : result.until;
      }
      if (line.values.length > 0 && line.values.every((value) => value === null)) line.error = 'has no such number';
      if (store.hello?.page?.other) await this.load_other(line, whole.from, whole.to);
    } catch (error) {
      line.error = (error as Error).message;
    }
    this.show_legend();
  }

  private async load_other(line: Line, from: number, to: number): Promise<void> {
    const { result } = await wire.request('series', { topic: line.topic, members: [line.member], from, to, points: recorded_points, other: true });
    line.other = [result.t, result.v.map(([value]: [unknown]) => number_of(line, value))];
    this.make();
  }

  // The server has changed: what was a run may be a recording.
  again(): void {
    for (const line of this.lines) line.stop();
    this.lines = [];
    for (const { topic, member } of this.entry.series) this.begin(topic, member);
    this.make();
  }

  private show_legend(): void {
    put(this.legend, this.lines.map((line, i) => {
      const sign = h('i');
      line.at = h('span', { class: 'at' });
      sign.style.background = palette[i % palette.length];
      return h('span', { title: `${line.topic} ${line.member}${line.error ? `: ${line.error}` : ''}` }, sign, `${signal_name(line)} ${name_of(line)}`, line.at, line.error ? h('em', null, ` ${line.error}`) : null, line.other ? h('span', { class: 'more' }, ` dashed: ${store.hello?.page?.other}`) : null,
        button(`Remove ${line.member}`, { icon: 'close', class: 'plain small' }, () => this.drop(i)));
    }), this.time, h('span', { class: 'spring' }), button('Save the plot as CSV', { icon: 'table', class: 'plain small csv' }, () => download(new Blob([this.csv()], { type: 'text/csv' }), 'plot.csv')));
  }

  private drop(i: number): void {
    this.lines[i].stop();
    this.lines.splice(i, 1);
    this.entry.series.splice(i, 1);
    keep();
    if (this.lines.length === 0) return this.remove();
    this.show_legend();
    this.make();
  }

  end(): void {
    for (const line of this.lines) line.stop();
    this.plot?.destroy();
  }

  private data(from: number, to: number): uPlot.AlignedData {
    const tables = [...this.lines.map((line): [number[], (number | null)[]] => [line.times, line.values]), ...this.others()].map(([times, values]) => {
      const first = Math.max(0, times.findIndex((t) => t >= from) - 1);
      let last = times.findIndex((t) => t > to);
      if (last < 0) last = times.length;
      return [times.slice(first, last), values.slice(first, last)] as [number[], (number | null)[]];
    });
    return tables.length === 1 ? tables[0] : uPlot.join(tables as never);
  }

  private readonly others = () => this.lines.flatMap((line) => (line.other ? [line.other] : []));

  make(): void {
    const { clientWidth: width, clientHeight: height } = this.body;
    this.plot?.destroy();
    this.plot = null;
    if (width < 40 || height < 30 || this.lines.length === 0) return;
    const style = getComputedStyle(this.element);
    const [line, dim] = [style.getPropertyValue('--line'), style.getPropertyValue('--dim')];
    const axis = { stroke: dim, grid: { stroke: line, width: 1 }, ticks: { stroke: line, size: 4 }, font: '11px system-ui' };
    this.plot = new uPlot({
      width, height, pxAlign: 0, legend: { show: false }, cursor: { sync: { key: 'studio' }, drag: { setScale: false, x: true, y: false, dist: 6 } },
      scales: { x: { time: false }, y: { range: (_, low, high) => around(low, high) } },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${t}`) }, { ...axis, size: 46 }],
      series: [{}, ...this.lines.map((_, i) => ({ stroke: palette[i % palette.length], width: 1.5, spanGaps: true, points: { show: false } })),
        ...this.lines.flatMap((line, i) => (line.other ? [{ stroke: palette[i % palette.length], width: 1.5, dash: [5, 4], spanGaps: true, points: { show: false } }] : []))],
      hooks: { draw: [(plot) => this.mark_moment(plot)], setSelect: [(plot) => this.select(plot)], setCursor: [(plot) => this.show_values(plot)] },
    }, this.data(-Infinity, Infinity), this.body);
  }

  private select(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < 6) return;
    this.has_dragged = true;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.zoom([plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x')]);
  }

  // Of each line the newest value that is not after the cursor.
  private show_values(plot: uPlot): void {
    const { idx } = plot.cursor;
    this.time.textContent = idx === null || idx === undefined || plot.data[0][idx] === undefined ? '' : `${plot.data[0][idx].toFixed(3)} s`;
    this.lines.forEach((line, i) => {
      let at = this.time.textContent === '' ? -1 : idx!;
      while (at >= 0 && typeof plot.data[i + 1]?.[at] !== 'number') --at;
      if (line.at) line.at.textContent = at < 0 ? '' : ` = ${Number((plot.data[i + 1][at] as number).toPrecision(6))}`;
    });
  }

  // All that the plot has of its lines, or the part that is looked at.
  csv(): string {
    const { min, max } = this.plot?.scales.x ?? {};
    const [times, ...columns] = this.data(this.is_zoomed ? min ?? -Infinity : -Infinity, this.is_zoomed ? max ?? Infinity : Infinity);
    const quoted = (text: string) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const names = [...this.lines.map((line) => `${line.topic} ${name_of(line)}`), ...this.lines.filter((line) => line.other).map((line) => `${store.hello?.page?.other}: ${line.topic} ${name_of(line)}`)];
    const rows = [['time [s]', ...names].map(quoted).join(',')];
    for (let i = 0; i < times.length; ++i) rows.push([times[i], ...columns.map((c) => c[i] ?? '')].join(','));
    return `${rows.join('\n')}\n`;
  }
  is_zoomed = false;
  private readonly time = h('span', { class: 'at' });

  private moment: number | null = null;
  private mark_moment(plot: uPlot): void {
    if (this.moment === null) return;
    const x = plot.valToPos(this.moment, 'x', true), { left, top, width, height } = plot.bbox;
    if (x < left || x > left + width) return;
    plot.ctx.fillStyle = getComputedStyle(this.element).getPropertyValue('--accent');
    plot.ctx.fillRect(Math.round(x), top, Math.max(1, devicePixelRatio), height);
  }

  // `moment`: a line marks it, where it is not the end of the plot.
  draw(from: number, to: number, moment: number | null, is_zoomed = false): void {
    this.moment = moment;
    this.is_zoomed = is_zoomed;
    if (!this.plot || this.plot.series.length !== this.lines.length + this.others().length + 1) return;
    this.plot.setData(this.data(from, to), false);
    this.plot.batch(() => {
      this.plot!.setScale('x', { min: from, max: Math.max(to, from + 0.01) });
    });
  }
}

export class Plots {
  readonly element = h('div', { class: 'plots' });
  private readonly hint = h('div', { class: 'notice' }, h('div', { class: 'card' }, h('p', null, 'Drag a signal here from the tree, or press the curve beside a value in the inspector.')));
  private plots: Plot[] = [];
  window = 30; // [s]
  private range: [number, number] | null = null; // that is looked at; null: as the time line has it
  private readonly back = button('Show all of the plots again', { label: 'Zoom out', class: 'zoom-out' }, () => this.zoom(null));

  private zoom(range: [number, number] | null): void {
    this.range = range && range[1] - range[0] > 1e-6 ? range : null;
    this.back.hidden = this.range === null;
    this.draw();
  }

  constructor(private readonly end: () => number, private readonly choose: (time: number) => void) {
    this.back.hidden = true;
    for (const entry of settings.plots) this.open(entry);
    this.show();
    this.element.addEventListener('dragover', (event) => event.preventDefault());
    this.element.addEventListener('drop', (event) => {
      event.preventDefault();
      first_member(event.dataTransfer?.getData('text/plain') ?? '').then((line) => line && this.add(line.topic, line.member));
    });
    on('settings', () => this.plots.forEach((p) => p.make()));
    let was_recording = false;
    on('hello', () => {
      if (was_recording || recording()) {
        this.zoom(null);
        this.plots.forEach((p) => p.again());
      }
      was_recording = recording() !== undefined;
    });
    setInterval(() => this.draw(), 66);
  }

  draw(): void {
    if (this.element.offsetParent === null) return;
    const whole = recording(), moment = this.end();
    if (this.range) {
      for (const plot of this.plots) plot.draw(...this.range, moment, true);
      return;
    }
    if (!whole) {
      for (const plot of this.plots) plot.draw(moment - this.window, moment, null);
      return;
    }
    const span = this.window === 0 ? whole.to - whole.from : Math.min(this.window, whole.to - whole.from);
    const from = Math.min(whole.to - span, Math.max(whole.from, moment - span / 2));
    for (const plot of this.plots) plot.draw(from, from + span, moment);
  }

  add(topic: string, member: string): void {
    if (this.plots.some((p) => p.has(topic, member))) return;
    const entry = { series: [{ topic, member }] };
    settings.plots.push(entry);
    this.open(entry);
    this.show();
    keep();
  }

  private open(entry: { series: { topic: string; member: string }[] }): void {
    const plot: Plot = new Plot(entry, () => {
      plot.end();
      this.plots.splice(this.plots.indexOf(plot), 1);
      settings.plots.splice(settings.plots.indexOf(entry), 1);
      keep();
      this.show();
    }, this.choose, (range) => this.zoom(range));
    this.plots.push(plot);
  }

  private show(): void {
    put(this.element, this.plots.length > 0 ? [...this.plots.map((p) => p.element), this.back] : this.hint);
  }
}

// Some room about the lines, and about one that is level but for rounding.
function around(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const room = high - low > 1e-9 + 1e-9 * size ? (high - low) * 0.08 : size > 1e-9 ? size * 0.5 : 1;
  return [low - room, high + room];
}

// The first number of a signal, for what was dropped: commands before stamps.
export async function first_member(topic: string): Promise<{ topic: string; member: string } | undefined> {
  if (!store.signals.some((s) => s.topic === topic)) return undefined;
  try {
    const { result } = await wire.request('members', { topic });
    const members: { path: string; type: string }[] = result.members ?? [];
    const numbers = members.filter((m) => m.type === 'number').map((m) => m.path);
    const member = first_of(numbers);
    if (member) return { topic, member };
  } catch { /* older servers: from a sample */ }
  return new Promise((resolve) => {
    const stop = watch({ topic, hz: 5 }, (values) => {
      if (!values.value) return;
      stop();
      const numbers = flatten(values.value).filter(([, v]) => typeof v === 'number').map(([k]) => k);
      const member = first_of(numbers);
      resolve(member ? { topic, member } : undefined);
    });
    setTimeout(() => { stop(); resolve(undefined); }, 5000);
  });
}

const first_of = (paths: string[]): string | undefined => paths.find((path) => !is_dull(path)) ?? paths.find((path) => !is_stamp(path)) ?? paths[0];
// Of a scan: where the sensor sits and how it is made.
const is_dull = (path: string): boolean => is_stamp(path) || /^(geometry|config)\./.test(path);
const is_stamp = (path: string): boolean => /(^|\.)(stamp|tm|header|sequence)(\.|$)/.test(path);
