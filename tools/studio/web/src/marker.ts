// What is selected is marked by the corners of a box round it.
import { Box3, BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Mesh, Scene, Vector3 } from 'three';
import type { Model } from './glb';

export class Marker {
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0xf2a516, depthTest: false, transparent: true }));

  constructor(scene: Scene) {
    this.lines.renderOrder = 10;
    this.lines.visible = false;
    this.lines.frustumCulled = false;
    this.lines.matrixAutoUpdate = false;
    scene.add(this.lines);
  }

  // The corners of a box round the selected model, turned with it.
  draw(model: Model | undefined): void {
    this.lines.visible = Boolean(model?.canonical);
    if (!model?.canonical) return;
    const box = new Box3(), part_box = new Box3();
    const inverse = model.canonical.matrixWorld.clone().invert();
    for (const link of model.links) {
      link.traverse((part) => {
        if (!(part instanceof Mesh) || part.userData.overlay || part.userData.ground) return;
        part.geometry.boundingBox ?? part.geometry.computeBoundingBox();
        box.union(part_box.copy(part.geometry.boundingBox!).applyMatrix4(part.matrixWorld).applyMatrix4(inverse));
      });
    }
    if (box.isEmpty() || box.getSize(new Vector3()).length() > 80) return void (this.lines.visible = false);
    box.expandByScalar(0.03);
    const points: number[] = [];
    const size = box.getSize(new Vector3());
    for (let corner = 0; corner < 8; ++corner) {
      const at = new Vector3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y, corner & 4 ? box.max.z : box.min.z);
      for (const axis of ['x', 'y', 'z'] as const) {
        const end = at.clone();
        end[axis] += (at[axis] === box.max[axis] ? -1 : 1) * Math.min(0.25 * size[axis], 0.3);
        points.push(...at.toArray(), ...end.toArray());
      }
    }
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.lines.matrix.copy(model.canonical.matrixWorld);
  }
}
