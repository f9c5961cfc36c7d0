// The moving models of the recording that is compared with, where they were at the shown time: translucent, in the world of the shown run.
import { Mesh, MeshBasicMaterial, Scene, SkinnedMesh } from 'three';
import { read_world, WorldScene } from './glb';
import { on, store, wire } from './store';
import { fetch_data } from './token';
import type { Poses } from './wire';

export class Ghosts {
  world: WorldScene | null = null;
  private is_asked = false;
  private readonly told = new Map<number, { view: DataView; at: number }>(); // by link
  // Behind what is at the same place: where both runs agree, only the model itself is seen.
  private readonly material = new MeshBasicMaterial({ color: 0xd9480f, transparent: true, opacity: 0.45, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 });

  constructor(private readonly scene: Scene, private readonly redraw: () => void) {
    wire.on('ghosts', (poses) => this.take(poses));
    on('scene', () => this.load());
  }

  private async load(): Promise<void> {
    if (this.is_asked || !store.hello?.page?.other) return;
    this.is_asked = true;
    const reply = await fetch_data('world.glb');
    if (!reply.ok) return;
    const world = await read_world(await reply.arrayBuffer());
    world.root.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      const model = world.models.get(part.userData.model);
      part.visible = part instanceof SkinnedMesh || (model !== undefined && !model.is_static);
      part.castShadow = part.receiveShadow = false;
      part.material = this.material;
    });
    this.world = world;
    this.scene.add(world.root);
    for (const [link, { view, at }] of this.told) this.place(link, view, at);
    this.redraw();
  }

  private take({ all, count, view }: Poses): void {
    if (all) this.told.clear();
    for (let i = 0, at = 24; i < count; ++i, at += 24) {
      const link = view.getUint32(at, true);
      this.told.set(link, { view, at });
      this.place(link, view, at);
    }
    this.redraw();
  }

  private place(index: number, view: DataView, at: number): void {
    const link = this.world?.links[index];
    if (!link) return;
    link.position.set(view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true));
    link.quaternion.set(view.getInt16(at + 16, true), view.getInt16(at + 18, true), view.getInt16(at + 20, true), view.getInt16(at + 22, true)).normalize();
  }
}
