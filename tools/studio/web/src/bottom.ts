// Time: run, pause, step, speed; the line of the last minutes; under it plots, logs, pictures and where a step's time goes.
import { button, h, icon, once_a_frame, put, unless_pressed, with_code } from './dom';
import { Breaks } from './breaks';
import { Contexts } from './contexts';
import { History } from './history';
import { Playback, recording } from './playback';
import { Plots } from './plots';
import { keep, settings } from './settings';
import { act, iface_id, on, read_only, selected_model, store, wire } from './store';
import { short_path } from './tree';
import { watch_image } from './watches';
import type { Participant } from './wire';

export class Bottom {
  readonly transport = h('div', { class: 'transport grip-place', role: 'toolbar', 'aria-label': 'Time' });
  readonly element = h('div', { class: 'bottom' });
  readonly plots: Plots;
  readonly breaks: Breaks;
  private readonly clock = h('output', { class: 'clock', 'aria-label': 'Simulated time' }, '–');
  private readonly rate = h('span', { class: 'rate' });
  private readonly waits = h('span', { class: 'waits' });
  private readonly run_button = button('Run', { icon: 'run', key: 'Space', id: 'run' }, () => this.run_or_pause());
  private readonly speed = h('input', { id: 'speed', type: 'number', min: 0, step: 'any', value: 1, class: 'number', title: 'Simulated seconds a second; 0: as fast as possible' });
  private readonly band = h('canvas', { class: 'band', role: 'img', 'aria-label': 'States of components over time' });
  private readonly scrub = h('input', { type: 'range', class: 'scrub', min: 0, max: 1, step: 'any', value: 1, 'aria-label': 'Shown time' });
  private readonly reset_button: HTMLButtonElement;
  private readonly live = button('Back to now', { label: 'Live', id: 'live', pressed: true }, () => this.look(null));
  private readonly tabs = h('div', { class: 'tabs', role: 'tablist', 'aria-label': 'Below the time line' });
  private readonly body = h('div', { class: 'tab-body', role: 'tabpanel' });
  private readonly log_filter = h('input', { type: 'search', placeholder: 'Filter', 'aria-label': 'Filter logs' });
  private readonly log_list = h('div', { class: 'log', role: 'log', tabindex: 0, 'aria-label': 'Logs' });
  private readonly offers = h('div', { class: 'offers' });
  private readonly images = h('div', { class: 'images' }, this.offers);
  private readonly parts = h('div', { class: 'parts', tabindex: 0, role: 'region', 'aria-label': 'Time per part' });
  private readonly contexts: Contexts;
  private shown_images = new Map<string, { stop: () => void; figure: HTMLElement }>();
  private moment: number | null = null;
  // What was asked for and is not told yet: the next press means the opposite of it, and not of what is shown.
  private wanted_paused: boolean | undefined = undefined;
  private wanted_speed: number | undefined = undefined;
  // What a step is: one of the simulator, or until this participant's next tick.
  private readonly step_box = h('select', { id: 'step-what', 'aria-label': 'What a step is', hidden: true }, h('option', { value: '' }, 'one step'));

  constructor(private readonly history: History, private readonly playback: Playback) {
    this.breaks = new Breaks(playback);
    this.plots = new Plots(() => this.moment ?? store.time?.sim_time ?? 0, (moment) => this.look(moment));
    const can = () => wire.status === 'open' && (recording() !== undefined || (!read_only() && store.world?.present && store.time !== null));
    const step_button = button('Step', { icon: 'step', key: '.', id: 'step' }, () => this.step());
    this.reset_button = button('Reset world and time', { icon: 'reset', key: 'Shift+R', id: 'reset' }, () => this.reset());
    // Enter by itself too: a browser does not tell of a change to what stood there before somebody else had changed it.
    const set_speed = () => {
      const rtf = Number(this.speed.value);
      if (recording()) {
        if (rtf > 0) this.playback.speed = rtf;
        return;
      }
      if (this.speed.value === '' || !(rtf >= 0) || rtf === (this.wanted_speed ?? store.time?.rtf_wanted)) return;
      this.wanted_speed = rtf;
      act('Set the speed', 'speed', { rtf }).then((result) => this.forget_wish(result, () => { if (this.wanted_speed === rtf) this.wanted_speed = undefined; }));
    };
    this.speed.addEventListener('change', set_speed);
    this.speed.addEventListener('keydown', (event) => { if (event.key === 'Enter') set_speed(); });
    const window_box = h('select', { 'aria-label': 'Length of the time line', onchange: () => { this.plots.window = Number(window_box.value); this.plots.draw(); this.draw_band(); } }, [10, 30, 60, 300].map((sec) => h('option', { value: sec, selected: sec === 30 }, sec < 60 ? `${sec} s` : `${sec / 60} min`)));
    this.transport.append(this.run_button, step_button, this.step_box, this.reset_button, this.clock, h('label', { class: 'speed', for: 'speed' }, '×'), this.speed, this.rate, this.waits, this.breaks.element, h('span', { class: 'spring' }), window_box, this.live);
    this.element.append(this.transport, h('div', { class: 'line-of-time' }, this.band, this.scrub), this.tabs, this.body);
    this.scrub.addEventListener('input', () => this.look(Number(this.scrub.value) >= Number(this.scrub.max) - 1e-6 ? null : Number(this.scrub.value)));
    this.log_filter.addEventListener('input', () => this.show_logs());
    on('time', () => {
      if (store.time?.paused === this.wanted_paused) this.wanted_paused = undefined;
      if (store.time?.rtf_wanted === this.wanted_speed) this.wanted_speed = undefined;
    });
    on('status', () => { this.wanted_paused = this.wanted_speed = undefined; });
    on(['time', 'world', 'status', 'hello'], once_a_frame(() => {
      this.show_time();
      for (const b of [this.run_button, step_button, this.reset_button]) b.disabled = !can();
      this.speed.disabled = !can();
    }));
    on('hello', () => {
      this.show_range();  // at once: a hand may be on the slider before the first frame
      if (this.moment !== null) this.leave_the_past();
      const all = window_box.querySelector('option[value="0"]');
      if (recording() ? all : !all) return;
      if (all) all.remove();
      else window_box.prepend(h('option', { value: 0 }, 'all'));
      window_box.value = all ? '30' : '0';
      this.plots.window = Number(window_box.value);
    });
    on('log', once_a_frame(() => { if (settings.tab === 'logs') unless_pressed(this.log_list, () => this.show_logs()); }));
    on('time', once_a_frame(() => { if (settings.tab === 'step') unless_pressed(this.parts, () => this.show_parts()); }));
    this.contexts = new Contexts(() => unless_pressed(this.parts, () => this.show_parts()), () => settings.tab === 'step' && this.parts.offsetParent !== null);
    on(['world', 'hello'], () => this.offer_images());
    on('scene', () => { if (this.moment !== null) this.look(null); });
    on('selection', () => { if (settings.tab === 'logs') this.show_logs(); });
    new ResizeObserver(() => this.draw_band()).observe(this.band);
    this.show_tab(settings.tab);
  }

  run_or_pause(): void {
    if (recording()) return this.playback.play_or_stop();
    if (read_only()) return;
    const pause = (this.wanted_paused ?? store.time?.paused) === false;
    this.wanted_paused = pause;
    (pause ? act('Pause', 'pause', {}) : act('Run', 'run', {})).then((result) => this.forget_wish(result, () => { if (this.wanted_paused === pause) this.wanted_paused = undefined; }));
    this.look(null);
  }
  // A refused one at once; one that was granted when it must have been told, also if somebody else has wished otherwise since.
  private forget_wish(result: unknown, forget: () => void): void {
    if (result) setTimeout(forget, 1000);
    else forget();
  }
  step(way = 1): void {
    if (recording()) return this.playback.step(way);
    if (read_only() || way < 0) return;
    const participant = this.step_box.value;
    if (participant) act(`Step to the next tick of ${participant}`, 'step', { participant });
    else act('Step', 'step', {});
  }
  reset(): void {
    if (recording()) return this.playback.seek(recording()!.from);
    if (read_only()) return;
    this.look(null);
    act('Reset the world', 'reset_world', {});
  }

  look(moment: number | null): void {
    if (recording()) return this.playback.seek(moment ?? this.history.last);
    this.mark_moment(moment);
    this.history.show(moment);
    this.show_time();
    this.plots.draw();
  }

  private mark_moment(moment: number | null): void {
    this.moment = moment;
    this.live.setAttribute('aria-pressed', String(moment === null));
    this.element.classList.toggle('past', moment !== null);
  }

  // What was looked back at is not shown any more.
  private leave_the_past(): void {
    this.mark_moment(null);
    this.history.show(null);
  }

  private show_time(): void {
    const { time } = store;
    const whole = recording();
    this.live.hidden = whole !== undefined;
    if (!time || !(whole || store.world?.present)) {
      this.clock.textContent = '–';
      this.rate.textContent = '';
      return;
    }
    if (this.moment !== null && this.moment > this.history.last) return this.look(null); // time has gone back
    this.offer_steps(time.participants ?? []);
    const shown = this.moment ?? time.sim_time;
    this.clock.textContent = `${shown.toFixed(3)} s`;
    this.rate.textContent = time.paused ? 'paused' : `${time.rtf.toFixed(time.rtf < 10 ? 2 : 0)} × real time`;
    const run = whole ? 'Play' : 'Run';
    const reset = whole ? 'To the beginning' : 'Reset world and time';
    this.reset_button.title = `${reset} (Shift+R)`;
    this.reset_button.setAttribute('aria-label', reset);
    const late = (time.participants ?? []).filter((p) => p.late).map((p) => p.name);
    this.waits.textContent = this.playback.problem ? this.playback.problem : time.waiting_for > 0 ? `waiting for ${time.waiting_for} to join` : late.length > 0 ? `waiting for ${late.join(', ')}` : (time.participants?.length ?? 0) > 0 ? `lock step, ${time.participants!.length === 1 ? '1 participant' : `${time.participants!.length} participants`}` : '';
    this.waits.classList.toggle('late', late.length > 0 || time.waiting_for > 0 || this.playback.problem !== '');
    put(this.run_button, icon(time.paused ? 'run' : 'pause'));
    this.run_button.setAttribute('aria-label', time.paused ? run : 'Pause');
    this.run_button.title = `${time.paused ? run : 'Pause'} (Space)`;
    if (document.activeElement !== this.speed) this.speed.value = String(Number(time.rtf_wanted.toPrecision(4)));
    this.show_range();
    this.scrub.value = String(whole ? this.playback.moment : shown); // where the hand has put it, also before that is shown
    this.scrub.setAttribute('aria-valuetext', `${shown.toFixed(1)} s`);
    this.draw_band();
  }

  private show_range(): void {
    this.scrub.min = String(this.history.first);
    this.scrub.max = String(Math.max(this.history.last, this.history.first + 0.001));
  }

  private offer_steps(participants: Participant[]): void {
    const names = [...new Set(participants.filter((p) => p.active).map((p) => p.name))];
    this.step_box.hidden = names.length === 0;
    if (names.join('\n') === [...this.step_box.options].slice(1).map((o) => o.value).join('\n')) return;
    const chosen = this.step_box.value;
    put(this.step_box, h('option', { value: '' }, 'one step'), names.map((name) => h('option', { value: name }, `tick of ${name}`)));
    this.step_box.value = names.includes(chosen) ? chosen : '';
  }

  // A row for each component: its states, in the colours of the diagram.
  private draw_band(): void {
    const { band } = this;
    const draw = band.getContext('2d');
    const width = band.clientWidth, height = band.clientHeight;
    if (!draw || width < 10 || height < 4) return;
    const ratio = devicePixelRatio || 1;
    if (band.width !== Math.round(width * ratio)) band.width = Math.round(width * ratio);
    if (band.height !== Math.round(height * ratio)) band.height = Math.round(height * ratio);
    draw.setTransform(ratio, 0, 0, ratio, 0, 0);
    draw.clearRect(0, 0, width, height);
    const style = getComputedStyle(band);
    const from = this.history.first, to = Math.max(this.history.last, from + 1);
    const shown = [...this.history.states].filter(([path]) => store.system.components.some((c) => c.path === path)).slice(0, 8);
    const row = height / Math.max(1, shown.length);
    shown.forEach(([, changes], i) => {
      changes.forEach(({ time, state }, k) => {
        const x = (Math.max(time, from) - from) / (to - from), end = ((changes[k + 1]?.time ?? to) - from) / (to - from);
        if (end <= 0) return;
        draw.fillStyle = style.getPropertyValue(`--state-${state.toLowerCase()}`);
        draw.fillRect(x * width, i * row + 0.5, Math.max(1, (end - x) * width), Math.max(1.5, row - 1));
      });
    });
    // Warnings and errors of logs, as marks on their moments.
    for (const [time, level] of recording()?.lines ?? []) {
      if (level !== 'ERROR' && level !== 'WARN') continue;
      draw.fillStyle = style.getPropertyValue(level === 'ERROR' ? '--bad' : '--warn');
      draw.fillRect(((time - from) / (to - from)) * width - 1, 0, 2, height);
    }
  }

  // ---- tabs ----

  show_tab(tab: typeof settings.tab): void {
    settings.tab = tab;
    const names: [typeof settings.tab, string, string][] = [['plots', 'Plots', 'plot'], ['logs', 'Logs', 'log'], ['images', 'Images', 'camera'], ['step', 'Step', 'step']];
    put(this.tabs, names.map(([id, text, sign]) => h('button', {
      type: 'button', role: 'tab', id: `tab-${id}`, 'aria-selected': String(tab === id), tabindex: tab === id ? 0 : -1, onclick: () => { this.show_tab(id); keep(); },
      onkeydown: (event: KeyboardEvent) => {
        const way = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
        if (way === 0) return;
        const at = names.findIndex(([name]) => name === id);
        const next = names[(at + way + names.length) % names.length][0];
        this.show_tab(next);
        document.getElementById(`tab-${next}`)?.focus();
      },
    }, icon(sign), text)));
    this.body.setAttribute('aria-labelledby', `tab-${tab}`);
    if (tab === 'logs') this.show_logs();
    if (tab === 'step') this.show_parts();
    put(this.body, tab === 'plots' ? this.plots.element : tab === 'logs' ? [h('div', { class: 'search' }, this.log_filter), this.log_list] : tab === 'images' ? this.images : this.parts);
    if (tab === 'images') this.offer_images();
  }

  private show_logs(): void {
    const words = this.log_filter.value.trim().toLowerCase();
    const now = store.selection;
    const only = now?.kind === 'component' ? short_path(now.id) : '';
    const lines = store.logs.filter((l) => (!words || `${l.level} ${l.source} ${l.text}`.toLowerCase().includes(words)) && (!only || l.source.includes(only))).slice(-400);
    const at_end = this.log_list.scrollTop + this.log_list.clientHeight > this.log_list.scrollHeight - 8;
    put(this.log_list, lines.length === 0 ? h('p', { class: 'hint' }, only ? `${only} has logged nothing yet.` : words ? 'No line matches the filter.' : 'Nothing has been logged yet.') : lines.map((l) => h('div', { class: `level-${l.level.toLowerCase()}` },
      h('span', { class: 'when' }, l.time === undefined ? '' : l.time > 1e9 ? new Date(l.time * 1000).toTimeString().slice(0, 8) : h('button', { type: 'button', class: 'link', title: 'Show this time', onclick: () => this.look(l.time!) }, `${l.time.toFixed(3)} s`)), h('span', { class: 'level' }, l.level), h('span', { class: 'source' }, short_path(l.source)), h('span', { class: 'text' }, l.text))));
    if (at_end) this.log_list.scrollTop = this.log_list.scrollHeight;
  }

  private show_parts(): void {
    const { time } = store;
    const parts = time?.parts ?? [];
    const all = Math.max(1e-9, parts.reduce((sum, p) => sum + (p.name === 'pace' ? 0 : p.total_ms), 0)); // what it waits for real time is no work
    const contexts = this.contexts.table();
    put(this.parts, parts.length === 0 && !contexts ? h('p', { class: 'hint' }, recording() ? 'A recording has no step times.' : 'No simulator is running.') : h('div', { class: 'columns' },
      parts.length === 0 ? null : h('table', null, h('caption', null, 'Time per physics step'), h('thead', null, h('tr', null, ['part', 'calls', 'mean', 'worst', 'share'].map((t) => h('th', { scope: 'col' }, t)))), h('tbody', null, parts.map((p) => h('tr', null, h('th', { scope: 'row' }, p.name), h('td', null, p.calls), h('td', null, `${((p.total_ms * 1000) / Math.max(1, p.calls)).toFixed(1)} µs`), h('td', null, `${p.max_us.toFixed(0)} µs`), h('td', null, p.name === 'pace' ? 'rest' : [bar(p.total_ms / all), `${((100 * p.total_ms) / all).toFixed(0)} %`]))))), contexts,
      (time?.participants?.length ?? 0) > 0 ? h('table', null, h('caption', null, 'Lock-step participants'), h('thead', null, h('tr', null, ['name', 'phase', 'rate', 'ticks', 'missed', 'mean', 'worst'].map((t) => h('th', { scope: 'col' }, t)), h('td'))), h('tbody', null, time!.participants!.map((p) => h('tr', { class: p.late ? 'late' : undefined }, h('th', { scope: 'row' }, p.name), h('td', null, p.phase), h('td', null, `${p.rate} Hz`), h('td', null, p.ticks), h('td', null, p.missed), h('td', null, `${p.mean_us.toFixed(0)} µs`), h('td', null, `${p.max_us.toFixed(0)} µs`),
        h('td', null, p.late ? button(`Remove ${p.name} from the lock step`, { label: 'Drop' }, () => act(`Drop ${p.name}`, 'drop_participant', { name: p.name })) : null))))) : null));
  }

  // ---- pictures ----

  // Those that are shown, and beside them what else can be.
  private offer_images(): void {
    const cameras = store.world?.ifaces.filter((i) => /camera|rgbd|depth/.test(i.type)) ?? [];
    // A world that is away, or on its way, does not say that a camera has gone.
    if (store.world?.present) for (const name of this.shown_images.keys()) if (/^(camera|rgbd|depth):/.test(name) && !cameras.some((c) => iface_id(c) === name)) this.close_image(name);
    const none = recording() ? 'This recording has no images.' : store.world?.present ? 'This world has no camera. `worlds/farm.sdf` has one, and so has the model `helicopter`, which can be spawned.' : 'No simulator is running.';
    put(this.offers, cameras.length === 0 && this.shown_images.size === 0 ? h('p', { class: 'hint' }, ...with_code(none))
      : cameras.filter((c) => !this.shown_images.has(iface_id(c))).map((c) => button(`Show the images of ${c.name}${c.type === 'depth' ? ', depth' : ''}`, { icon: 'camera', label: camera_label(iface_id(c)) }, () => this.show_image(iface_id(c)))));
  }

  private close_image(iface: string): void {
    const shown = this.shown_images.get(iface);
    this.shown_images.delete(iface);
    shown?.stop();
    shown?.figure.remove();
  }

  // `iface`: with its type, "depth:robot::eyes".
  show_image(iface: string): void {
    if (settings.tab !== 'images') this.show_tab('images');
    if (this.shown_images.has(iface)) return;
    const image = h('img', { alt: `What ${camera_label(iface)} sees` });
    const when = h('span', { class: 'more' });
    const end = () => {
      this.close_image(iface);
      this.offer_images();
    };
    const figure = h('figure', null, image, h('figcaption', null, camera_label(iface), ' ', when, button(`Close the image of ${camera_label(iface)}`, { icon: 'close', class: 'plain small' }, end)));
    this.offers.before(figure);
    let url = '';
    const stop = watch_image(iface, { hz: 10 }, (jpeg, time) => {
      if (url) URL.revokeObjectURL(url);
      url = URL.createObjectURL(jpeg);
      image.src = url;
      when.textContent = `${time.toFixed(2)} s`;
    }, (why) => { when.textContent = why; });
    this.shown_images.set(iface, { stop, figure });
    this.offer_images();
  }

  selected(): string | undefined {
    return selected_model();
  }
}

const camera_label = (id: string): string => id.replace(/^camera:/, '').replace(/^depth:(.*)$/, '$1 depth');

function bar(share: number): HTMLElement {
  const fill = h('i');
  fill.style.width = `${(100 * share).toFixed(1)}%`;
  return h('span', { class: 'share' }, fill);
}
