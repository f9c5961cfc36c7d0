// Arrows and rings above the selected model while the tool Move is in hand: a drag on one moves or turns the model along or about that axis.
import { Object3D, Quaternion, Scene, Vector3 } from 'three';
import { TransformControls } from 'three/examples/jsm/controls/TransformControls.js';
import { pose_of, type Model } from './glb';
import type { Reach } from './hands';
import { act, wire } from './store';

const wxyz = (q: Quaternion): number[] => [q.w, q.x, q.y, q.z];

export class Gizmo {
  private readonly proxy = new Object3D();
  private readonly all: TransformControls[] = [];
  private model: Model | null = null;
  private from: number[] = [];
  private lift = new Vector3();
  private sending: Promise<void> = Promise.resolve();
  private is_sending = false;
  is_dragged = false;

  constructor(private readonly view: Reach, scene: Scene) {
    scene.add(this.proxy);
    for (const [mode, size] of [['translate', 0.75], ['rotate', 0.5]] as const) {
      const controls = new TransformControls(view.eye.camera, view.canvas);
      controls.setMode(mode);
      controls.setSpace('world');
      controls.setSize(size);
      controls.addEventListener('change', () => view.redraw());
      controls.addEventListener('axis-changed' as never, () => {
        if (controls.axis === 'XYZ' || controls.axis === 'XYZE' || controls.axis === 'E') controls.axis = null;
        // The plane of a drag is that of the axis at once: a press may come before the next picture, and a drag that begins off its plane moves the model from 0 0 0.
        else controls.getHelper().updateMatrixWorld();
      });
      controls.addEventListener('dragging-changed', (event) => (event.value ? this.begin() : this.end()));
      controls.addEventListener('objectChange', () => this.send());
      scene.add(controls.getHelper());
      this.all.push(controls);
    }
  }

  // The mouse is on one of its handles, or drags it.
  is_under_mouse(): boolean {
    return this.is_dragged || this.all.some((controls) => controls.object && controls.axis !== null);
  }

  // Before each picture. Null: nothing is to be moved.
  show(model: Model | null): void {
    if (this.is_dragged && model) return;
    this.is_dragged = this.is_dragged && model !== null;
    this.model = model?.canonical ? model : null;
    for (const [i, controls] of this.all.entries()) {
      controls.camera = this.view.eye.camera;
      if (!this.model) controls.detach();
      else if (controls.object !== this.proxy) controls.attach(this.proxy);
      controls.enabled = this.model !== null && (i === 0 || this.all[0].axis === null); // arrows before rings
    }
    if (!this.model) return;
    const { position, quaternion } = pose_of(this.model);
    this.lift.set(0, 0, this.model.height + 0.15);
    this.proxy.position.copy(position).add(this.lift);
    this.proxy.quaternion.copy(quaternion);
    this.proxy.updateMatrixWorld();
    for (const controls of this.all) controls.getHelper().updateMatrixWorld();
  }

  private pose(): number[] {
    return [...this.proxy.position.clone().sub(this.lift).toArray(), ...wxyz(this.proxy.quaternion)];
  }

  private begin(): void {
    if (this.is_dragged || !this.model) return;
    this.is_dragged = true;
    const { position, quaternion } = pose_of(this.model);
    this.from = [...position.toArray(), ...wxyz(quaternion)];
  }

  // One at a time: requests are carried out in any order.
  private send(): void {
    if (!this.is_dragged || !this.model || this.is_sending) return;
    this.is_sending = true;
    this.sending = wire.request('set_pose', { model: this.model.name, pose: this.pose() }).then(() => {}, () => {}).finally(() => { this.is_sending = false; });
  }

  private end(): void {
    if (!this.is_dragged || !this.model) return;
    this.is_dragged = false;
    const { name } = this.model, { from } = this, pose = this.pose();
    if (pose.every((value, i) => Math.abs(value - from[i]) < 1e-9)) return;
    act(`Move ${name}`, 'set_pose', { model: name, pose }, () => ({ text: `Put ${name} back`, name: 'set_pose', args: { model: name, pose: from } }), this.sending);
  }

  // Where on the screen an arrow is taken hold of, for tests.
  handle(axis: 'X' | 'Y' | 'Z'): [number, number] {
    const way = { X: new Vector3(1, 0, 0), Y: new Vector3(0, 1, 0), Z: new Vector3(0, 0, 1) }[axis];
    const centre = this.proxy.position.clone(), eye = this.view.eye.camera.position;
    const size = (centre.distanceTo(eye) * Math.min((1.9 * Math.tan((Math.PI * (this.view.eye.perspective.fov)) / 360)), 7) * 0.75) / 4;
    const at = centre.addScaledVector(way, 0.45 * size).project(this.view.eye.camera), box = this.view.canvas.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  }
}
