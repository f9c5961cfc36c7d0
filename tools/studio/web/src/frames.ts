// The frames of models and links as axes: x red, y green, z blue. Of the selected model with the names of its links, else of all that moves;
// the world's own at its origin.
import { BoxGeometry, InstancedMesh, Matrix4, MeshBasicMaterial, Object3D, Scene, Vector3 } from 'three';
import type { WorldScene } from './glb';
import { settings } from './settings';

const world_axis = 1, model_axis = 0.35, link_axis = 0.18; // [m]
const most = 3000; // frames
const colors = [0xe03030, 0x1f9d3a, 0x2f62ff];

// Along one axis, one metre long: scaled to what it belongs to.
function bar(axis: number): BoxGeometry {
  const size = [0.035, 0.035, 0.035], middle = [0, 0, 0];
  size[axis] = 1;
  middle[axis] = 0.5;
  return new BoxGeometry(...size).translate(middle[0], middle[1], middle[2]);
}

export interface Spot { name: string; place: Vector3 }

export class Frames {
  count = 0;
  private bars: InstancedMesh[] = [];
  private room = 0;

  constructor(private readonly scene: Scene) {}

  // What is to be named of it: the links of the selected model.
  draw(world: WorldScene, selected: string | undefined): Spot[] {
    this.count = 0;
    for (const bars of this.bars) bars.visible = settings.frames;
    if (!settings.frames) return [];
    const chosen = world.models.get(selected ?? '');
    const models = chosen ? [chosen] : [...world.models.values()].filter((model) => !model.is_static);
    const frames: { link: Object3D; size: number }[] = [];
    for (const { links, canonical } of models) for (const link of links) if (frames.length < most) frames.push({ link, size: link === canonical ? model_axis : link_axis });
    this.hold(frames.length + 1);
    this.put(new Matrix4(), world_axis);
    for (const { link, size } of frames) this.put(link.matrixWorld, size);
    for (const bars of this.bars) {
      bars.count = this.count;
      bars.instanceMatrix.needsUpdate = true;
    }
    return chosen ? chosen.links.map((link) => ({ name: link.name.slice(link.name.lastIndexOf(':') + 1), place: new Vector3().setFromMatrixPosition(link.matrixWorld) })) : [];
  }

  private put(frame: Matrix4, size: number): void {
    const place = frame.clone().scale(new Vector3(size, size, size));
    for (const bars of this.bars) bars.setMatrixAt(this.count, place);
    this.count += 1;
  }

  private hold(frames: number): void {
    if (this.room >= frames) return;
    for (const bars of this.bars) {
      bars.removeFromParent();
      bars.geometry.dispose();
      bars.dispose();
    }
    this.room = 2 * frames;
    this.bars = colors.map((color, axis) => {
      const bars = new InstancedMesh(bar(axis), new MeshBasicMaterial({ color, depthTest: false, transparent: true }), this.room);
      bars.frustumCulled = false;
      bars.renderOrder = 12;
      bars.userData.overlay = true;
      this.scene.add(bars);
      return bars;
    });
  }
}
