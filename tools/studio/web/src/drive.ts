// Driving a robot by keys or an on-screen stick. The server stops it when nothing comes for half a second.
import { button, h } from './dom';
import { act, on, selected_model, store, wire } from './store';

const fastest = { x: 0.4, aside: 0.4, turn: 1.2, up: 0.5 };

export class Drive {
  readonly element = h('div', { class: 'drive', hidden: true });
  private readonly stick = h('div', { class: 'stick', role: 'application', tabindex: 0, 'aria-label': 'Stick: arrow keys or W A S D drive, Escape ends' });
  private readonly knob = h('div', { class: 'knob' });
  private readonly text = h('span', { class: 'text' });
  private iface = '';
  private keys = new Set<string>();
  private at = { x: 0, y: 0 };
  private timer = 0;
  private is_asked = false;
  private sent = '';

  constructor() {
    this.stick.append(this.knob);
    this.element.append(h('div', { class: 'head' }, this.text, button('Stop driving', { icon: 'close', class: 'plain small', key: 'Escape' }, () => this.end())), this.stick);
    this.stick.addEventListener('pointerdown', (event) => {
      this.stick.setPointerCapture(event.pointerId);
      this.move(event);
    });
    this.stick.addEventListener('pointermove', (event) => { if (event.buttons > 0) this.move(event); });
    for (const end of ['pointerup', 'pointercancel']) this.stick.addEventListener(end, () => this.set(0, 0));
    this.stick.addEventListener('keydown', (event) => this.key(event, true));
    this.stick.addEventListener('keyup', (event) => this.key(event, false));
    this.stick.addEventListener('blur', () => {
      this.keys.clear();
      this.set(0, 0);
    });
    on('status', () => { if (wire.status !== 'open') this.end(); });
  }

  is_on(): boolean {
    return this.iface !== '';
  }

  toggle(): void {
    if (this.iface) return this.end();
    const model = selected_model();
    const drives = store.world?.ifaces.filter((i) => i.type === 'position2d' || i.type === 'position3d') ?? [];
    const one = drives.find((i) => i.model === model) ?? (drives.length === 1 ? drives[0] : undefined);
    if (one) this.begin(one.name);
  }

  begin(iface: string): void {
    this.iface = iface;
    this.text.textContent = `Drives ${iface.split('::')[0]}`;
    this.element.hidden = false;
    this.stick.focus();
    act(`Drive ${iface}`, 'drive', { iface, velocity: this.velocity() });
    clearInterval(this.timer);
    this.timer = window.setInterval(() => this.send(), 100);
  }

  end(): void {
    if (!this.iface) return;
    clearInterval(this.timer);
    if (wire.status === 'open') wire.request('release', { iface: this.iface }).catch(() => {});
    this.iface = '';
    this.element.hidden = true;
    this.set(0, 0);
  }

  private velocity(): number[] {
    const is_3d = store.world?.ifaces.find((i) => i.name === this.iface && i.type.startsWith('position'))?.type === 'position3d';
    const forward = this.at.y * fastest.x, turn = -this.at.x * fastest.turn;
    const lift = Number(this.keys.has('e')) - Number(this.keys.has('q'));
    // On the ground Q goes to the left and E to the right; drives that cannot go sideways ignore it.
    return is_3d ? [forward, 0, lift * fastest.up, 0, 0, turn] : [forward, -lift * fastest.aside, turn];
  }

  // One at a time: a server that is late gets the newest next, and not all that was wanted meanwhile.
  private send(): void {
    if (this.is_asked || !this.iface) return;
    this.is_asked = true;
    const { iface } = this, velocity = this.velocity();
    this.sent = String(velocity);
    wire.request('drive', { iface, velocity }).catch((error) => {
      this.text.textContent = error.message;
    }).finally(() => {
      this.is_asked = false;
      if (String(this.velocity()) !== this.sent) this.send();
    });
  }

  private set(x: number, y: number): void {
    const far = Math.max(1, Math.hypot(x, y));
    this.at = { x: x / far, y: y / far };
    this.knob.style.transform = `translate(${this.at.x * 34}px,${-this.at.y * 34}px)`;
  }

  private move(event: PointerEvent): void {
    const box = this.stick.getBoundingClientRect();
    this.set(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
  }

  private key(event: KeyboardEvent, is_down: boolean): void {
    const names: { [key: string]: string } = { ArrowUp: 'w', ArrowDown: 's', ArrowLeft: 'a', ArrowRight: 'd', w: 'w', s: 's', a: 'a', d: 'd', e: 'e', q: 'q' };
    if (event.key === 'Escape') return this.end();
    const key = names[event.key];
    if (!key || event.ctrlKey || event.metaKey) return;
    if (is_down) this.keys.add(key);
    else this.keys.delete(key);
    const has = (k: string) => Number(this.keys.has(k));
    this.set(has('d') - has('a'), has('w') - has('s'));
    event.preventDefault();
    event.stopPropagation();
  }
}
