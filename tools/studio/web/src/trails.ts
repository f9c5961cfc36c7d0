// Where robots have been: a line behind each, with a point every 5 cm.
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Scene, Vector3 } from 'three';
import type { Model } from './glb';
import { palette } from './palette';
import { settings } from './settings';

interface Trail { line: Line; points: Float32Array; count: number; last: Vector3 }

const longest = 4000; // [points]

export class Trails {
  private trails = new Map<string, Trail>();

  constructor(private readonly scene: Scene) {}

  apply_settings(): void {
    for (const trail of this.trails.values()) trail.line.visible = settings.trails;
  }

  // Of models that are not there any more.
  keep(names: Set<string>): void {
    for (const [name, { line }] of this.trails) {
      if (names.has(name)) continue;
      this.scene.remove(line);
      line.geometry.dispose();
      (line.material as LineBasicMaterial).dispose();
      this.trails.delete(name);
    }
  }

  forget(): void {
    for (const trail of this.trails.values()) {
      trail.count = 0;
      trail.last.set(1e9, 0, 0);
      trail.line.geometry.setDrawRange(0, 0);
    }
  }

  lengthen(models: Model[]): void {
    for (const model of models) {
      if (!model.canonical) continue;
      let trail = this.trails.get(model.name);
      if (!trail) {
        const points = new Float32Array(longest * 3);
        const geometry = new BufferGeometry();
        geometry.setAttribute('position', new BufferAttribute(points, 3));
        const line = new Line(geometry, new LineBasicMaterial({ color: palette[this.trails.size % palette.length] }));
        line.frustumCulled = false;
        line.visible = settings.trails;
        line.userData.overlay = true;
        this.scene.add(line);
        trail = { line, points, count: 0, last: new Vector3(1e9, 0, 0) };
        this.trails.set(model.name, trail);
      }
      const p = model.canonical.position;
      const way = trail.last.distanceTo(p);
      if (way < 0.05) continue;
      if (way > 1 && way < 1e8) trail.count = 0; // put somewhere else
      trail.last.copy(p);
      if (trail.count === longest) {
        trail.points.copyWithin(0, 3 * 400);
        trail.count -= 400;
      }
      trail.points.set([p.x, p.y, p.z + 0.02], 3 * trail.count++);
      trail.line.geometry.getAttribute('position').needsUpdate = true;
      trail.line.geometry.setDrawRange(0, trail.count);
    }
  }
}
