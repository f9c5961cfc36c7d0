// The joints of a model as chains from its base, and positions of one that bring its tip to a place: damped least squares within the limits.
import { Matrix3, Matrix4, Quaternion, Vector3 } from 'three';

// As the simulator describes it: `parent` is 1 + the id of the joint that carries it, 0: the base; `pose` that of its frame at position 0.
export interface Joint {
  name: string; id: number; kind: number; lower: number | null; upper: number | null; max_velocity: number; max_effort: number;
  link?: string; parent?: number; axis?: number[]; pose?: { position: number[]; orientation: number[] };
}

export const turns = (joint: Joint): boolean => joint.kind === 1;

const max_tries = 200;
const longest_step = 0.05; // [m] of the tip
const widest_step = 0.2;   // [rad or m] of a joint
const least_damping = 0.01, max_damping = 100; // [m/rad]
const close = 1e-5;        // [m]

const has_place = (joint: Joint): boolean => Array.isArray(joint.axis) && Array.isArray(joint.pose?.position) && Array.isArray(joint.pose?.orientation);
const within = (joint: Joint, value: number): number => Math.max(joint.lower ?? -Infinity, Math.min(joint.upper ?? Infinity, value));

export class Chain {
  private readonly frames: Matrix4[];
  private readonly axes: Vector3[];

  private constructor(readonly joints: Joint[]) {
    this.frames = joints.map(({ pose }) => {
      const [w, x, y, z] = pose!.orientation;
      return new Matrix4().compose(new Vector3().fromArray(pose!.position), new Quaternion(x, y, z, w), new Vector3(1, 1, 1));
    });
    this.axes = joints.map(({ axis }) => new Vector3().fromArray(axis!).normalize());
  }

  // From the base to this joint. Null: it has fewer than two joints.
  static to(tip: Joint, all: Joint[]): Chain | null {
    const joints: Joint[] = [];
    for (let joint: Joint | undefined = tip; joint && has_place(joint) && joints.length < all.length; joint = all.find(({ id }) => id + 1 === joint!.parent)) joints.unshift(joint);
    return joints.length > 1 && !joints[0].parent ? new Chain(joints) : null;
  }

  // The end of the longest row of joints from the base: the last before two that it carries, as the fingers of a hand.
  static tip_of(all: Joint[]): Joint | undefined {
    const carried = (id: number) => all.filter(({ parent }) => parent === id + 1);
    const rows = all.filter(({ parent }) => !parent).map((root) => {
      const row = [root];
      for (let next = carried(root.id); next.length === 1 && row.length <= all.length; next = carried(next[0].id)) row.push(next[0]);
      return row;
    });
    const longest = rows.reduce<Joint[]>((a, b) => (b.length > a.length ? b : a), []);
    return longest.length > 1 ? longest[longest.length - 1] : undefined;
  }

  // In the frame of `base`, as all that follows. `each`: the frame of each joint before its motion.
  frame(positions: number[], base: Matrix4, each?: (at: Matrix4, i: number) => void): Matrix4 {
    const at = base.clone(), motion = new Matrix4();
    this.joints.forEach((joint, i) => {
      at.multiply(this.frames[i]);
      each?.(at, i);
      if (turns(joint)) motion.makeRotationAxis(this.axes[i], positions[i]);
      else motion.makeTranslation(this.axes[i].clone().multiplyScalar(positions[i]));
      at.multiply(motion);
    });
    return at;
  }

  // Positions, from `start` on, that bring `offset` of the last link to `target`, or as near as the joints let it.
  reach(base: Matrix4, offset: Vector3, start: number[], target: Vector3): number[] {
    let positions = start.map((value, i) => within(this.joints[i], value));
    let now = this.moved(positions, base, offset), damping = least_damping;
    for (let i = 0; i < max_tries && damping < max_damping; ++i) {
      const way = target.clone().sub(now.point), distance = way.length();
      if (distance < close) break;
      const next = this.step(positions, now.columns, way.clampLength(0, longest_step), damping), there = this.moved(next, base, offset);
      const is_nearer = there.point.distanceTo(target) < distance - 1e-9;
      if (is_nearer) [positions, now] = [next, there];
      damping = is_nearer ? Math.max(least_damping, damping / 2) : damping * 3; // near a stretched arm small steps alone lead on
    }
    return positions;
  }

  // Where the point is, and how each joint moves it [m/rad or m/m].
  private moved(positions: number[], base: Matrix4, offset: Vector3): { point: Vector3; columns: Vector3[] } {
    const axes: Vector3[] = [], places: Vector3[] = [];
    const last = this.frame(positions, base, (at, i) => {
      axes.push(this.axes[i].clone().transformDirection(at));
      places.push(new Vector3().setFromMatrixPosition(at));
    });
    const point = offset.clone().applyMatrix4(last);
    return { point, columns: axes.map((axis, i) => (turns(this.joints[i]) ? axis.cross(point.clone().sub(places[i])) : axis)) };
  }

  // A joint that would leave its limits stands still, and the others make up for it.
  private step(positions: number[], columns: Vector3[], way: Vector3, damping: number): number[] {
    const moves = columns.map(() => true);
    for (;;) {
      const steps = damped(columns.map((column, i) => (moves[i] ? column : new Vector3())), way, damping);
      const wanted = positions.map((value, i) => value + Math.max(-widest_step, Math.min(widest_step, steps[i])));
      const beyond = wanted.findIndex((value, i) => moves[i] && value !== within(this.joints[i], value) && positions[i] === within(this.joints[i], value));
      if (beyond < 0) return wanted.map((value, i) => within(this.joints[i], value));
      moves[beyond] = false;
    }
  }
}

function damped(columns: Vector3[], way: Vector3, damping: number): number[] {
  const sum = new Array(9).fill(0);
  for (const { x, y, z } of columns) [x * x, x * y, x * z, y * x, y * y, y * z, z * x, z * y, z * z].forEach((value, i) => { sum[i] += value; });
  for (const i of [0, 4, 8]) sum[i] += damping * damping;
  const pull = way.clone().applyMatrix3(new Matrix3().fromArray(sum).invert());
  return columns.map((column) => column.dot(pull));
}
