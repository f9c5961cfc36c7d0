// The mouse on models: a click selects, a double click follows; with a tool in hand they are moved, turned and pushed.
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Mesh, Object3D, Plane, Quaternion, Raycaster, Scene, Vector2, Vector3 } from 'three';
import { pose_of, type Model, type WorldScene } from './glb';
import { Gizmo } from './gizmo';
import type { Joints } from './joints';
import { Tip } from './tip';
import type { Eye } from './orbit';
import { act, changed, read_only, select, selected_model, wire } from './store';

export type Tool = 'look' | 'move' | 'push';

// What they reach into.
export interface Reach { canvas: HTMLCanvasElement; eye: Eye; world: WorldScene | null; redraw(): void; follow(model: string): void }

interface Drag { model: Model; at: Vector3; seen: Vector3; offset: Vector3; from: number[]; yaw: number; last: number; turn: { x: number; yaw: number; place: Vector3 } | null }

export class Hands {
  tool: Tool = 'look';
  private readonly arrow = new Line(new BufferGeometry(), new LineBasicMaterial({ color: 0xe0452a, depthTest: false, transparent: true }));
  private drag: Drag | null = null;
  private placing: Promise<void> = Promise.resolve();
  private is_placing = false;
  menu: (event: MouseEvent, model: string) => void = () => {};

  readonly gizmo: Gizmo;
  private tip: Tip | null = null;
  private clicked: (model: string, link: string) => void = () => {};

  constructor(private readonly view: Reach, private readonly scene: Scene) {
    this.gizmo = new Gizmo(view, scene);
    this.arrow.renderOrder = 10;
    this.arrow.visible = false;
    this.arrow.frustumCulled = false;
    scene.add(this.arrow);
    this.listen();
  }

  // Arrows at the tip of the arm whose joints are shown.
  move_tips_of(joints: Joints): void {
    this.tip = new Tip(this.view, this.scene, joints);
    this.clicked = (model, link) => joints.click(model, link);
    joints.redraw = () => this.view.redraw();
  }

  // A press of the mouse says where, on the ground or on what is there, and a drag from it which way; Escape gives up.
  private placing_of: { take: (at: { position: number[]; yaw: number }) => void; at: Vector3 | null } | null = null;
  ask_place(take: (at: { position: number[]; yaw: number }) => void): void {
    this.placing_of = { take, at: null };
    this.view.canvas.parentElement!.dataset.tool = 'place';
    this.view.canvas.focus({ preventScroll: true });
  }

  private end_place(): void {
    this.placing_of = null;
    this.arrow.visible = false;
    this.view.canvas.parentElement!.dataset.tool = this.tool;
    this.view.redraw();
  }

  // True: the event was for a place.
  private place(event: PointerEvent): boolean {
    const { placing_of: now } = this;
    if (!now) return false;
    if (event.type === 'pointerdown') now.at = event.button === 0 ? this.surface(event) : null;
    if (!now.at) return event.button === 0;
    const to = this.on_plane(event, now.at.z) ?? now.at, way = to.clone().sub(now.at), has_way = way.length() > 0.1;
    this.arrow.visible = has_way;
    this.arrow.geometry.setAttribute('position', new BufferAttribute(new Float32Array([...now.at.toArray(), ...to.toArray()]), 3));
    this.view.redraw();
    if (event.type !== 'pointerup') return true;
    this.end_place();
    now.take({ position: now.at.toArray(), yaw: has_way ? Math.atan2(way.y, way.x) : 0 });
    return true;
  }

  // Of what the mouse is over, the ground of the world too; else of the plane z = 0.
  private surface(event: PointerEvent): Vector3 | null {
    const hits = this.view.world ? this.ray(event).intersectObject(this.view.world.root, true) : [];
    return hits.find(({ object }) => !object.userData.overlay && object instanceof Mesh)?.point ?? this.on_plane(event, 0);
  }

  private ray(event: { clientX: number; clientY: number }): Raycaster {
    const box = this.view.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2), this.view.eye.camera as never);
    return ray;
  }

  private hit(event: { clientX: number; clientY: number }): { model: string; link: string; point: Vector3 } | null {
    if (!this.view.world) return null;
    const hits = this.ray(event).intersectObject(this.view.world.root, true);
    const found = hits.find(({ object }) => !object.userData.overlay && !object.userData.ground && object instanceof Mesh && model_name(object));
    return found ? { model: model_name(found.object)!, link: this.link_name(found.object), point: found.point } : null;
  }

  // Without the name of its model.
  private link_name(object: Object3D | null): string {
    if (!object) return '';
    return this.view.world!.links.includes(object) ? object.name.slice(object.name.indexOf('::') + 2) : this.link_name(object.parent);
  }

  private on_plane(event: PointerEvent, z: number): Vector3 | null {
    return this.ray(event).ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -z), new Vector3());
  }

  // True: this press is for a model, and does not turn the eye.
  begin_drag(event: PointerEvent): boolean {
    if (this.placing_of && event.button === 0) {
      this.view.canvas.setPointerCapture(event.pointerId);
      return this.place(event);
    }
    if (event.button === 0 && this.tip?.is_under_mouse()) return true;
    if (this.tool === 'look' || event.button !== 0 || read_only()) return false;
    if (this.gizmo.is_under_mouse()) return true;
    const hit = this.hit(event);
    const model = hit && this.view.world!.models.get(hit.model);
    if (!hit || !model?.canonical || model.is_static) return false;
    select({ kind: 'model', id: model.name });
    const { position, quaternion } = pose_of(model);
    const x = new Vector3(1, 0, 0).applyQuaternion(quaternion);
    this.drag = {
      model, from: [...position.toArray(), ...wxyz(quaternion)], at: hit.point.clone(), seen: hit.point.clone(), offset: position.clone().sub(hit.point), yaw: Math.atan2(x.y, x.x), last: 0, turn: null,
    };
    this.view.canvas.setPointerCapture(event.pointerId);
    return true;
  }

  private go_on(event: PointerEvent, is_end: boolean): void {
    const { drag } = this;
    if (!drag) return;
    const seen = this.on_plane(event, drag.at.z);
    if (!seen && !is_end) return;
    const point = seen ?? drag.seen.clone(); // let go over the sky: where it was last
    drag.seen = point.clone();
    if (this.tool === 'push') {
      this.arrow.visible = !is_end;
      this.arrow.geometry.setAttribute('position', new BufferAttribute(new Float32Array([...drag.at.toArray(), ...point.toArray()]), 3));
      if (is_end) this.push(drag.model.name, point.sub(drag.at));
    } else if (is_end || event.timeStamp - drag.last > 80) {
      drag.last = event.timeStamp;
      const place = this.turned(drag, event) ?? point.add(drag.offset);
      const args = { model: drag.model.name, planar: [place.x, place.y, drag.yaw] };
      const { from, model: { name } } = drag;
      // One at a time: requests are carried out in any order, and the last place is the one that counts.
      if (is_end) act(`Move ${name}`, 'set_pose', args, () => ({ text: `Put ${name} back`, name: 'set_pose', args: { model: name, pose: from } }), this.placing);
      else if (!this.is_placing) {
        this.is_placing = true;
        this.placing = wire.request('set_pose', args).then(() => {}, () => {}).finally(() => { this.is_placing = false; });
      }
    }
    if (is_end) this.drag = null;
    this.view.redraw();
  }

  // With Ctrl or Alt it turns where it is, a hundredth radian for each pixel to the right.
  private turned(drag: Drag, event: PointerEvent): Vector3 | null {
    if (!event.ctrlKey && !event.altKey) return (drag.turn = null);
    drag.turn ??= { x: event.clientX, yaw: drag.yaw, place: pose_of(drag.model).position };
    drag.yaw = drag.turn.yaw + (event.clientX - drag.turn.x) * 0.01;
    return drag.turn.place;
  }

  // 100 N for each metre of the arrow, for a fifth of a second.
  private push(model: string, way: Vector3): void {
    if (way.length() < 0.02) return;
    const force = way.multiplyScalar(100).toArray().map((f) => Math.round(f));
    act(`Push ${model}`, 'push', { name: model, force, seconds: 0.2 });
  }

  // Before each picture; `is_now`: not of the past.
  show_gizmo(is_now: boolean): void {
    const model = this.view.world?.models.get(selected_model() ?? '');
    const moved = is_now && model && !read_only() && !this.drag ? model : null;
    this.tip?.show(moved);
    this.gizmo.show(this.tool === 'move' && !moved?.is_static ? moved : null);
  }

  set_tool(tool: Tool): void {
    this.tool = this.tool === tool ? 'look' : tool;
    this.view.canvas.parentElement!.dataset.tool = this.tool;
    changed('settings');
  }

  private listen(): void {
    let down: [number, number] | null = null;
    this.view.canvas.addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; });
    this.view.canvas.addEventListener('pointermove', (event) => { if (!this.placing_of?.at || !this.place(event)) this.go_on(event, false); });
    this.view.canvas.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !this.placing_of) return;
      this.end_place();
      event.stopPropagation();
    });
    this.view.canvas.addEventListener('pointerup', (event) => {
      if (this.place(event)) return;
      if (this.drag) return this.go_on(event, true);
      if (this.gizmo.is_under_mouse() || this.tip?.is_under_mouse()) return;
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4 || event.button === 1) return;
      const hit = this.hit(event);
      if (event.button === 2) return void (hit && this.menu(event, hit.model)); // with a drag it moves the eye
      select(hit ? { kind: 'model', id: hit.model } : null);
      if (hit) this.clicked(hit.model, hit.link);
    });
    this.view.canvas.addEventListener('pointercancel', () => {
      this.drag = null;
      this.arrow.visible = false;
      this.view.redraw();
    });
    this.view.canvas.addEventListener('dblclick', (event) => {
      const hit = this.hit(event);
      if (hit) this.view.follow(hit.model);
    });
  }
}

const wxyz = ({ w, x, y, z }: Quaternion): number[] => [w, x, y, z];

function model_name(object: Object3D | null): string | undefined {
  return object ? (object.userData.model as string | undefined) ?? model_name(object.parent) : undefined;
}
