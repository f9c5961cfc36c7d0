// Arrows at the tip of the selected arm: a drag moves the joints so that the tip follows, or comes as near as it can.
import { Box3, Matrix4, Mesh, Object3D, Scene, Vector3 } from 'three';
import { TransformControls } from 'three/examples/jsm/controls/TransformControls.js';
import { Chain } from './arm';
import { pose_of, type Model } from './glb';
import type { Reach } from './hands';
import type { Joints } from './joints';

const one = new Vector3(1, 1, 1);

export class Tip {
  private readonly proxy = new Object3D();
  private readonly controls: TransformControls;
  private arm: { chain: Chain; base: Matrix4; offset: Vector3; positions: number[] } | null = null;
  is_dragged = false;

  constructor(private readonly view: Reach, scene: Scene, private readonly joints: Joints) {
    scene.add(this.proxy);
    this.controls = new TransformControls(view.eye.camera, view.canvas);
    this.controls.setSize(0.6);
    this.controls.addEventListener('change', () => view.redraw());
    // As in gizmo.ts: the plane of a drag is that of the axis at once.
    this.controls.addEventListener('axis-changed' as never, () => this.controls.getHelper().updateMatrixWorld());
    this.controls.addEventListener('dragging-changed', (event) => (event.value ? this.begin() : this.end()));
    this.controls.addEventListener('objectChange', () => this.follow());
    scene.add(this.controls.getHelper());
  }

  is_under_mouse(): boolean {
    return this.is_dragged || (this.controls.object !== undefined && this.controls.axis !== null);
  }

  // Before each picture. Null: no model, or one that cannot be moved.
  show(model: Model | null): void {
    if (this.is_dragged && model) return;
    this.is_dragged = false;
    this.controls.camera = this.view.eye.camera;
    this.arm = model?.canonical ? this.arm_of(model) : null;
    this.controls.enabled = this.arm !== null;
    if (!this.arm) return void this.controls.detach();
    if (this.controls.object !== this.proxy) this.controls.attach(this.proxy);
    const { chain, base, offset, positions } = this.arm;
    this.proxy.position.copy(offset).applyMatrix4(chain.frame(positions, base));
    this.proxy.updateMatrixWorld();
    this.controls.getHelper().updateMatrixWorld();
  }

  private arm_of(model: Model): typeof this.arm {
    const now = this.joints.arm();
    const chain = now && Chain.to(now.tip, now.joints);
    if (!chain) return null;
    const positions = chain.joints.map(({ id }) => now.positions[id]);
    if (!positions.every(Number.isFinite)) return null;
    const { position, quaternion } = pose_of(model), base = new Matrix4().compose(position, quaternion, one);
    const link = model.links.find(({ name }) => name === `${model.name}::${now.tip.link}`);
    return { chain, base, positions, offset: link ? middle_of(link) : new Vector3() };
  }

  private begin(): void {
    this.is_dragged = this.arm !== null;
  }

  private follow(): void {
    if (!this.is_dragged || !this.arm) return;
    const { chain, base, offset, positions } = this.arm;
    this.arm.positions = chain.reach(base, offset, positions, this.proxy.position);
    this.joints.pull(Object.fromEntries(chain.joints.map(({ name }, i) => [name, this.arm!.positions[i]])));
  }

  private end(): void {
    if (!this.is_dragged) return;
    this.is_dragged = false;
    this.joints.let_go_of_tip();
    this.view.redraw();
  }

  // Where it is, on the screen, for tests.
  place(): number[] | null {
    return this.arm && this.proxy.position.toArray();
  }
}

// Of its shapes, in its own frame.
function middle_of(link: Object3D): Vector3 {
  const box = new Box3(), inverse = new Matrix4();
  link.updateMatrixWorld(true);
  inverse.copy(link.matrixWorld).invert();
  link.traverse((part) => {
    if (!(part instanceof Mesh) || part.userData.overlay || !part.geometry.boundingBox) return;
    box.union(new Box3().copy(part.geometry.boundingBox).applyMatrix4(new Matrix4().multiplyMatrices(inverse, part.matrixWorld)));
  });
  return box.isEmpty() ? new Vector3() : box.getCenter(new Vector3());
}
