// The joints of a model: where they are, and sliders that move them. A command is renewed while its slider is held, and to a position until
// the joint has arrived; then the joint is left to its brake, as `simctl joints` does.
import { in_degrees } from './angles';
import { Chain, turns, type Joint } from './arm';
import { button, h, put } from './dom';
import { act, iface_id, on, read_only, store, wire } from './store';
import { fixed, format } from './values';
import { watch } from './watches';
import type { Iface } from './wire';

interface State { position: number; velocity: number; effort: number; target: number; mode: number; status: number }
interface Command { mode: string; value: number; is_held: boolean; is_known: boolean } // known: the simulator has it
interface Row { joint: Joint; actual: HTMLElement; target: HTMLElement; slider: HTMLInputElement; number: HTMLInputElement; free: HTMLElement }

const modes = ['no command', 'position', 'velocity', 'effort', 'free', 'brake', 'disabled'];
const statuses = ['idle', 'moving', 'braked', 'stalled'];
const renewal = 150; // [ms]; the server releases after 500
const moving = 1, position = 1;

const shown = (joint: Joint, mode: string, value: number): number => (turns(joint) && mode !== 'effort' ? in_degrees(value) : value);
const unit_of = (joint: Joint, mode: string): string => (mode === 'effort' ? (turns(joint) ? ' N m' : ' N') : turns(joint) ? (mode === 'velocity' ? '°/s' : '°') : mode === 'velocity' ? ' m/s' : ' m');
const text_of = (joint: Joint, mode: string, value: number): string => `${fixed(shown(joint, mode, value), turns(joint) ? 1 : 3)}${unit_of(joint, mode)}`;

// Without limits a turn, or a metre, to each side.
function range_of(joint: Joint, mode: string): [number, number] {
  if (mode === 'velocity') return [-joint.max_velocity, joint.max_velocity];
  if (mode === 'effort') return [-joint.max_effort, joint.max_effort];
  const far = turns(joint) ? Math.PI : 1;
  return [typeof joint.lower === 'number' ? joint.lower : -far, typeof joint.upper === 'number' ? joint.upper : far];
}

export class Joints {
  readonly element = h('section', { class: 'joints', 'aria-label': 'Joints' });
  private iface: Iface | undefined;
  private made_of = '';
  private mode = 'position';
  private rows: Row[] = [];
  private states: State[] = [];
  private readonly commands = new Map<string, Command>();
  private readonly brakes = new Set<string>(); // to be sent once
  private readonly problem = h('p', { class: 'problem', role: 'alert' });
  private stop: (() => void) | null = null;
  private timer = 0;
  private is_asked = false;
  private tip = ''; // the link whose arrows are shown
  private pulled: Record<string, number> = {};
  redraw = (): void => {};

  constructor(private readonly plot: (topic: string, member: string) => void) {
    on('status', () => { if (wire.status !== 'open') this.forget(); });
  }

  // '': none. What was commanded is released when another model is shown.
  show(model: string): void {
    const iface = model ? store.world?.ifaces.find((i) => i.type === 'joints' && i.model === model) : undefined;
    const made_of = iface ? JSON.stringify([iface.name, iface.info, read_only(), store.world?.birth]) : '';
    if (made_of === this.made_of) return;
    this.release();
    this.stop?.();
    this.stop = null;
    this.made_of = made_of;
    if (iface?.name !== this.iface?.name) this.tip = '';
    this.iface = iface;
    this.states = [];
    this.make();
    if (this.clicked?.model === model) this.choose_tip(this.clicked.link);
    this.clicked = null;
    if (iface) this.stop = watch({ topic: iface_id(iface), hz: 10 }, ({ value, error }) => { if (!error) this.take((value as { joints?: State[] } | undefined)?.joints ?? []); });
  }

  private make(): void {
    const joints = (this.iface?.info?.joints ?? []) as Joint[];
    this.rows = joints.map((joint) => this.row(joint));
    this.problem.textContent = '';
    put(this.element);
    if (joints.length === 0) return;
    const select_mode = h('select', { id: 'joint-mode', 'aria-label': 'What the sliders set', disabled: read_only(), onchange: () => {
      this.mode = select_mode.value;
      this.release();
      this.make();
      this.take(this.states);
    } }, ['position', 'velocity', 'effort'].map((mode) => h('option', { value: mode, selected: mode === this.mode }, mode)));
    put(this.element, h('h3', null, 'Joints', read_only() ? null : select_mode, this.tip_button(joints)), this.problem,
      this.rows.map(({ joint, actual, target, slider, number, free }) => h('div', { class: 'joint' },
        h('div', { class: 'line' }, this.plot_button(joint), h('label', { for: slider.id }, joint.name), actual, target),
        h('span', { class: 'slider' }, slider, number),
        h('div', { class: 'line' }, h('span', { class: 'more limits' }, range_of(joint, this.mode).map((v) => text_of(joint, this.mode, v)).join(' … ')), read_only() ? null : [free,
          button(`Brake ${joint.name}`, { label: 'Brake', class: 'small' }, () => this.brake(joint))]))));
  }

  private tip_button(joints: Joint[]): HTMLElement | null {
    const tip = Chain.tip_of(joints);
    if (!tip?.link || read_only() || !Chain.to(tip, joints)) return null;
    return button(`Arrows at the tip of the arm (${tip.link}): a drag moves the joints`, { id: 'joint-tip', label: 'Tip', class: 'small', pressed: this.tip !== '' }, () => this.choose_tip(this.tip ? '' : tip.link!));
  }

  // The link may be clicked on before its model is shown.
  private clicked: { model: string; link: string } | null = null;
  click(model: string, link: string): void {
    if (this.iface?.model === model) this.choose_tip(link);
    else this.clicked = { model, link };
  }

  // The last link of an arm has arrows; '': none has. Others change nothing.
  private choose_tip(link: string): void {
    const joints = (this.iface?.info?.joints ?? []) as Joint[];
    const joint = joints.find((one) => one.link === link);
    const is_last = joint && (joint === Chain.tip_of(joints) || !joints.some(({ parent }) => parent === joint.id + 1));
    if (link && (!is_last || !Chain.to(joint, joints) || read_only())) return;
    this.tip = link;
    document.getElementById('joint-tip')?.setAttribute('aria-pressed', String(link !== ''));
    this.redraw();
  }

  // What the arrows at its tip move. Null: there are none.
  arm(): { tip: Joint; joints: Joint[]; positions: number[] } | null {
    const joints = (this.iface?.info?.joints ?? []) as Joint[], tip = this.tip ? joints.find(({ link }) => link === this.tip) : undefined;
    return tip && this.states.length > 0 ? { tip, joints, positions: this.states.map(({ position }) => position) } : null;
  }

  private plot_button(joint: Joint): HTMLElement | null {
    const topic = store.signals.find((s) => s.type === 'joints' && s.model === this.iface?.model)?.topic;
    return topic ? button(`Plot ${joint.name}`, { icon: 'plot', class: 'plain small' }, () => this.plot(topic, `joints[${joint.id}].position`)) : null;
  }

  private row(joint: Joint): Row {
    const [low, high] = range_of(joint, this.mode).map((v) => shown(joint, this.mode, v));
    const disabled = read_only();
    const slider = h('input', { id: `joint-${joint.name}`, type: 'range', min: low, max: high, step: 'any', disabled, value: 0 });
    const number = h('input', { id: `joint-number-${joint.name}`, type: 'number', min: low, max: high, step: 'any', disabled, value: 0, 'aria-label': `${joint.name} [${unit_of(joint, this.mode).trim()}]` });
    const free = button(`Free ${joint.name}: no motor, no brake`, { label: 'Free', class: 'small', pressed: false }, () => this.toggle_free(joint));
    for (const field of [slider, number]) {
      const other = field === slider ? number : slider;
      field.addEventListener(field === slider ? 'input' : 'change', () => {
        if (field.value === '' || !Number.isFinite(Number(field.value))) return;
        other.value = field.value;
        this.set(joint, Number(field.value), field === slider);
      });
    }
    slider.addEventListener('change', () => this.let_go(joint));
    // A velocity or an effort is held as long as somebody holds it.
    for (const [field, end] of [[slider, 'pointerup'], [slider, 'pointercancel'], [slider, 'blur'], [number, 'blur']] as [HTMLInputElement, string][])
      field.addEventListener(end, () => { if (this.mode !== 'position') this.end(joint); });
    return { joint, actual: h('span', { class: 'actual' }, '–'), target: h('span', { class: 'more' }), slider, number, free };
  }

  // ---- commands

  private set(joint: Joint, value: number, is_held: boolean): void {
    const radians = turns(joint) && this.mode !== 'effort' ? (value * Math.PI) / 180 : value;
    this.begin(joint, { mode: this.mode, value: radians, is_held, is_known: false });
    if (!is_held) this.let_go(joint);
  }

  // The command shows in the status line.
  private let_go(joint: Joint): void {
    const command = this.commands.get(joint.name);
    if (!command || !this.iface) return;
    command.is_held = this.mode !== 'position';
    act(`Move ${joint.name} of ${this.iface.model}`, 'move_joints', { iface: this.iface.name, joints: { [joint.name]: { mode: command.mode, value: command.value } } });
  }

  // The tip is dragged: all of its joints are commanded at once, until it is let go and they have arrived.
  pull(positions: Record<string, number>): void {
    this.pulled = positions;
    for (const [name, value] of Object.entries(positions)) {
      this.brakes.delete(name);
      this.commands.set(name, { mode: 'position', value, is_held: true, is_known: false });
    }
    this.go_on();
  }

  let_go_of_tip(): void {
    if (!this.iface || Object.keys(this.pulled).length === 0) return;
    for (const name of Object.keys(this.pulled)) {
      const command = this.commands.get(name);
      if (command) command.is_held = false;
    }
    act(`Move the tip of ${this.iface.model}`, 'move_joints', { iface: this.iface.name, joints: Object.fromEntries(Object.entries(this.pulled).map(([name, value]) => [name, { mode: 'position', value }])) });
    this.pulled = {};
  }

  private toggle_free(joint: Joint): void {
    if (this.commands.get(joint.name)?.mode === 'free') return this.end(joint);
    this.begin(joint, { mode: 'free', value: 0, is_held: true, is_known: false });
    act(`Free ${joint.name} of ${this.iface!.model}`, 'move_joints', { iface: this.iface!.name, joints: { [joint.name]: { mode: 'free' } } });
  }

  private brake(joint: Joint): void {
    this.commands.delete(joint.name);
    act(`Brake ${joint.name} of ${this.iface!.model}`, 'move_joints', { iface: this.iface!.name, joints: { [joint.name]: { mode: 'brake' } } }).then(() => this.end(joint));
  }

  private begin(joint: Joint, command: Command): void {
    this.brakes.delete(joint.name);
    this.commands.set(joint.name, command);
    this.go_on();
  }

  private go_on(): void {
    this.mark();
    if (!this.timer) this.timer = window.setInterval(() => this.send(), renewal);
    this.send();
  }

  // Back to its brake.
  private end(joint: Joint): void {
    if (this.commands.delete(joint.name)) this.brakes.add(joint.name);
    if (this.mode !== 'position') for (const { joint: one, slider, number } of this.rows) if (one === joint) slider.value = number.value = '0';
    this.mark();
    if (this.commands.size === 0) this.release();
  }

  release(): void {
    const was = this.timer !== 0;
    this.forget();
    if (was && this.iface && wire.status === 'open') wire.request('release', { iface: this.iface.name }).catch(() => {});
  }

  private forget(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.commands.clear();
    this.brakes.clear();
    this.mark();
  }

  private mark(): void {
    for (const { joint, free } of this.rows) free.setAttribute('aria-pressed', String(this.commands.get(joint.name)?.mode === 'free'));
  }

  // One at a time: a server that is late gets the newest next.
  private send(): void {
    if (this.is_asked || !this.iface || this.commands.size === 0) return;
    this.is_asked = true;
    const sent = [...this.commands];
    const joints = Object.fromEntries([...[...this.brakes].map((name) => [name, { mode: 'brake' }]), ...sent.map(([name, { mode, value }]) => [name, mode === 'free' ? { mode } : { mode, value }])]);
    this.brakes.clear();
    wire.request('move_joints', { iface: this.iface.name, joints }).then(() => {
      this.problem.textContent = '';
      for (const [, command] of sent) command.is_known = true;
    }, (error) => {
      this.problem.textContent = error.message;
      this.forget();
    }).finally(() => {
      this.is_asked = false;
      if (sent.some(([name, command]) => this.commands.get(name) !== command)) this.send();
    });
  }

  // ---- what comes

  private take(states: State[]): void {
    this.states = states;
    if (this.tip) this.redraw();
    for (const { joint, actual, target, slider, number } of this.rows) {
      const state = states[joint.id];
      if (!state) continue;
      const mode = modes[state.mode] ?? '?';
      actual.textContent = text_of(joint, 'position', state.position);
      const has_target = state.mode >= 1 && state.mode <= 3;
      target.textContent = `${has_target ? `→ ${text_of(joint, mode, state.target)}, ` : ''}${mode}, ${statuses[state.status] ?? '?'}`;
      actual.title = `${text_of(joint, 'velocity', state.velocity)}, ${text_of(joint, 'effort', state.effort)}`;
      const is_in_use = this.commands.has(joint.name) || document.activeElement === number || document.activeElement === slider;
      if (this.mode === 'position' && !is_in_use) {
        slider.value = String(shown(joint, 'position', state.position));
        number.value = format(Number(shown(joint, 'position', state.position).toFixed(turns(joint) ? 1 : 3)));
      }
      this.end_if_arrived(joint, state);
    }
  }

  private end_if_arrived(joint: Joint, state: State): void {
    const command = this.commands.get(joint.name);
    if (!command || command.is_held || !command.is_known || command.mode !== 'position') return;
    const [low, high] = range_of(joint, 'position');
    const wanted = joint.lower === null && joint.upper === null ? command.value : Math.max(low, Math.min(high, command.value));
    if (state.mode === position && Math.abs(state.target - wanted) < 1e-6 && state.status !== moving) this.end(joint);
  }
}
