// Where robots have been: a line behind each, with a point every 5 cm; of a past moment, where they had been then.
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Scene, Vector3 } from 'three';
import { palette } from './palette';
import { settings } from './settings';

// `jumps`: points at which it was put somewhere else; a line begins at the last of them.
interface Trail { line: Line; points: Float32Array; times: Float64Array; count: number; jumps: number[]; last: Vector3 }
export interface Mover { name: string; position: Vector3 }

const longest = 4000; // [points]

export class Trails {
  private trails = new Map<string, Trail>();
  private moment = Infinity; // that is shown [s]

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
      trail.jumps = [];
      trail.last.set(1e9, 0, 0);
      trail.line.geometry.setDrawRange(0, 0);
    }
  }

  // Null: of now.
  show(moment: number | null): void {
    this.moment = moment ?? Infinity;
    for (const trail of this.trails.values()) this.draw(trail);
  }

  private draw({ line, times, count, jumps }: Trail): void {
    let end = count;
    while (end > 0 && times[end - 1] > this.moment + 1e-9) --end;
    const start = jumps.findLast((jump) => jump < end) ?? 0;
    line.geometry.setDrawRange(start, end - start);
  }

  lengthen(movers: Mover[], time: number): void {
    for (const { name, position: p } of movers) {
      const trail = this.trails.get(name) ?? this.begin(name);
      if (trail.count > 0 && time < trail.times[trail.count - 1]) {
        trail.count = 0; // time was set back
        trail.jumps = [];
      }
      const way = trail.last.distanceTo(p);
      if (way < 0.05) continue;
      if (trail.count === longest) this.shorten(trail);
      if (way > 1 && way < 1e8) trail.jumps.push(trail.count);
      trail.last.copy(p);
      trail.times[trail.count] = time;
      trail.points.set([p.x, p.y, p.z + 0.02], 3 * trail.count++);
      trail.line.geometry.getAttribute('position').needsUpdate = true;
      this.draw(trail);
    }
  }

  private begin(name: string): Trail {
    const points = new Float32Array(longest * 3);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(points, 3));
    const line = new Line(geometry, new LineBasicMaterial({ color: palette[this.trails.size % palette.length] }));
    line.frustumCulled = false;
    line.visible = settings.trails;
    line.userData.overlay = true;
    this.scene.add(line);
    const trail = { line, points, times: new Float64Array(longest), count: 0, jumps: [], last: new Vector3(1e9, 0, 0) };
    this.trails.set(name, trail);
    return trail;
  }

  private shorten(trail: Trail): void {
    const oldest = 400;
    trail.points.copyWithin(0, 3 * oldest);
    trail.times.copyWithin(0, oldest);
    trail.count -= oldest;
    trail.jumps = trail.jumps.map((jump) => jump - oldest).filter((jump) => jump > 0);
  }
}
