// The eye: round a point, from above, behind a model, or where a camera is. Mouse, touch, pen and keys.
import { Camera, MathUtils, Object3D, OrthographicCamera, PerspectiveCamera, Quaternion, Vector3 } from 'three';

export type EyeMode = 'orbit' | 'top' | 'follow' | 'sensor' | 'fixed';
export interface EyeState { mode: EyeMode; target: number[]; azimuth: number; elevation: number; distance: number; span: number; what?: string }

// From the camera of three.js (looks along -z, y up) to ours (looks along x, z up).
export const to_ours = new Quaternion(0.5, -0.5, -0.5, 0.5);

export class Eye {
  readonly perspective = new PerspectiveCamera(57.3, 1, 0.05, 500);
  readonly parallel = new OrthographicCamera(-1, 1, 1, -1, 0.1, 2000);
  mode: EyeMode = 'orbit';
  what = '';
  target = new Vector3();
  azimuth = -1.98;
  elevation = 0.62;
  distance = 12;
  span = 12;
  followed: Object3D | null = null;
  private heading = 0;
  private width = 1;
  private height = 1;
  private fov = 1.0; // horizontal [rad]

  constructor(private readonly canvas: HTMLElement, private readonly moved: () => void, private readonly may_turn: (event: PointerEvent) => boolean) {
    this.perspective.up.set(0, 0, 1);
    this.parallel.up.set(0, 1, 0);
    this.listen();
  }

  get angle(): number {
    return this.fov;
  }
  get camera(): Camera {
    return this.mode === 'top' ? this.parallel : this.perspective;
  }

  resize(width: number, height: number): void {
    [this.width, this.height] = [Math.max(1, width), Math.max(1, height)];
    this.update();
  }

  set_mode(mode: EyeMode, what = '', followed: Object3D | null = null): void {
    if (mode === 'top' && this.mode !== 'top') this.span = Math.max(2, this.distance * 1.15);
    if (this.mode === 'sensor' && mode !== 'sensor') this.fov = 1.0;
    this.mode = mode;
    this.what = what;
    this.followed = followed;
    if (mode === 'follow' && followed) this.heading = this.heading_of(followed);
    this.moved();
  }

  // As the simulator says it: place, and rotation of an eye that looks along x with z up; horizontal field of view [rad].
  fix(position: number[], rotation: number[], fov: number): void {
    this.mode = 'fixed';
    this.fov = fov;
    this.perspective.position.fromArray(position);
    this.perspective.quaternion.fromArray(rotation).multiply(to_ours);
    this.moved();
  }

  // Begins an orbit where the eye is.
  orbit_from(position: Vector3, target: Vector3): void {
    const way = position.clone().sub(target);
    this.target.copy(target);
    this.distance = Math.max(0.1, way.length());
    this.azimuth = Math.atan2(way.y, way.x);
    this.elevation = Math.asin(MathUtils.clamp(way.z / this.distance, -1, 1));
    this.mode = 'orbit';
    this.fov = 1.0;
    this.moved();
  }

  state(): EyeState {
    const round = (x: number) => Math.round(x * 1000) / 1000;
    return { mode: this.mode, target: this.target.toArray().map(round), azimuth: round(this.azimuth), elevation: round(this.elevation), distance: round(this.distance), span: round(this.span), what: this.what };
  }

  restore(state: EyeState): void {
    this.target.fromArray(state.target);
    Object.assign(this, { azimuth: state.azimuth, elevation: state.elevation, distance: state.distance, span: state.span });
    this.mode = ['top', 'follow', 'sensor'].includes(state.mode) ? state.mode : 'orbit';
    this.what = state.what ?? '';
    this.moved();
  }

  private heading_of(object: Object3D): number {
    const x = new Vector3(1, 0, 0).applyQuaternion(object.getWorldQuaternion(new Quaternion()));
    return Math.atan2(x.y, x.x);
  }

  update(): void {
    const aspect = this.width / this.height;
    if (this.followed && (this.mode === 'follow' || this.mode === 'sensor')) this.go_along(this.followed);
    this.parallel.left = -this.span / 2;
    this.parallel.right = this.span / 2;
    this.parallel.top = this.span / aspect / 2;
    this.parallel.bottom = -this.parallel.top;
    this.parallel.position.set(this.target.x, this.target.y, 500);
    this.parallel.lookAt(this.target.x, this.target.y, 0);
    if (this.mode === 'orbit' || this.mode === 'follow') {
      const flat = Math.cos(this.elevation) * this.distance;
      const turn = this.azimuth;
      this.perspective.position.set(this.target.x + flat * Math.cos(turn), this.target.y + flat * Math.sin(turn), this.target.z + Math.sin(this.elevation) * this.distance);
      this.perspective.lookAt(this.target);
    }
    this.perspective.aspect = aspect;
    this.perspective.fov = MathUtils.radToDeg(2 * Math.atan(Math.tan(this.fov / 2) / aspect));
    this.perspective.near = this.mode === 'orbit' || this.mode === 'follow' ? Math.max(0.01, this.distance * 0.01) : 0.03;
    this.perspective.far = Math.max(300, this.distance * 20);
    this.perspective.updateProjectionMatrix();
    this.parallel.updateProjectionMatrix();
  }

  private go_along(object: Object3D): void {
    if (this.mode === 'sensor') {
      this.fov = (object.userData.fov as number) ?? 1.047;
      object.getWorldPosition(this.perspective.position);
      object.getWorldQuaternion(this.perspective.quaternion).multiply(to_ours);
      return;
    }
    object.getWorldPosition(this.target);
    const heading = this.heading_of(object);
    // Slowly round, so that a robot that turns on the spot does not whirl the world.
    const turn = MathUtils.euclideanModulo(heading - this.heading + Math.PI, 2 * Math.PI) - Math.PI;
    this.heading += turn * 0.15;
    this.azimuth += turn * 0.15;
  }

  turn(right: number, up: number): void {
    if (this.mode === 'fixed' || this.mode === 'sensor') return;
    if (this.mode === 'top') return this.pan(-right * 80, up * 80);
    this.azimuth -= right;
    this.elevation = MathUtils.clamp(this.elevation + up, -1.5, 1.55);
    this.moved();
  }

  // Pixels.
  pan(right: number, down: number): void {
    if (this.mode === 'fixed' || this.mode === 'sensor') return;
    if (this.mode === 'follow') this.mode = 'orbit';
    const metres = this.mode === 'top' ? this.span / this.width : (2 * this.distance * Math.tan(this.fov / 2)) / this.width;
    if (this.mode === 'top') this.target.add(new Vector3(-right * metres, down * metres, 0));
    else {
      const forward = new Vector3(-Math.cos(this.azimuth), -Math.sin(this.azimuth), 0);
      const left = new Vector3(-forward.y, forward.x, 0);
      this.target.addScaledVector(left, right * metres).addScaledVector(forward, down * metres / Math.max(0.3, Math.sin(Math.abs(this.elevation))));
    }
    this.moved();
  }

  zoom(factor: number): void {
    this.distance = MathUtils.clamp(this.distance * factor, 0.2, 2000);
    this.span = MathUtils.clamp(this.span * factor, 0.5, 4000);
    this.moved();
  }

  private listen(): void {
    const fingers = new Map<number, PointerEvent>();
    const { canvas } = this;
    canvas.addEventListener('pointerdown', (event) => {
      if (!this.may_turn(event)) return;
      fingers.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', (event) => {
      const last = fingers.get(event.pointerId);
      if (!last) return;
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY;
      if (fingers.size === 2) {
        const other = [...fingers.values()].find((f) => f.pointerId !== event.pointerId)!;
        const gap = (f: PointerEvent) => Math.hypot(f.clientX - other.clientX, f.clientY - other.clientY);
        this.zoom(gap(last) / Math.max(10, gap(event)));
        this.pan(dx / 2, dy / 2);
      } else if (event.shiftKey || (event.buttons & 6) !== 0 || this.mode === 'top') this.pan(dx, dy);
      else this.turn(dx * 0.006, dy * 0.006);
      fingers.set(event.pointerId, event);
    });
    const end = (event: PointerEvent) => fingers.delete(event.pointerId);
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(MathUtils.clamp(event.deltaY, -200, 200) * 0.0015));
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const keys: { [key: string]: () => void } = {
        ArrowLeft: () => (event.shiftKey ? this.pan(40, 0) : this.turn(-0.1, 0)), ArrowRight: () => (event.shiftKey ? this.pan(-40, 0) : this.turn(0.1, 0)),
        ArrowUp: () => (event.shiftKey ? this.pan(0, 40) : this.turn(0, 0.1)), ArrowDown: () => (event.shiftKey ? this.pan(0, -40) : this.turn(0, -0.1)),
        '+': () => this.zoom(0.85), '=': () => this.zoom(0.85), '-': () => this.zoom(1.18),
      };
      if (!keys[event.key] || event.defaultPrevented || event.ctrlKey || event.metaKey) return;
      keys[event.key]();
      event.preventDefault();
    });
  }
}
