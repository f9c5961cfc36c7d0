// The world: drawn here from one export of the simulator, moved by streamed poses.
import { Box3, type Camera, Mesh, PCFSoftShadowMap, Scene, ShaderMaterial, SkinnedMesh, Vector3, WebGLRenderer } from 'three';
import { Backdrop } from './backdrop';
import { Contacts } from './contacts';
import { Daylight } from './daylight';
import { Frames } from './frames';
import { Ghosts } from './ghosts';
import { button, h, put, with_code } from './dom';
import { Model, read_world, WorldScene } from './glb';
import { Hands } from './hands';
import { Labels } from './labels';
import { Latecomers } from './latecomers';
import { Marker } from './marker';
import { linear, place_lights } from './material';
import { Eye, EyeState, to_ours } from './orbit';
import { Pace } from './pace';
import { has_run } from './run_blocks';
import { Ranges } from './ranges';
import { settings } from './settings';
import { changed, link_problem, on, selected_model, store, wire } from './store';
import { type Mover, Trails } from './trails';
import type { Poses } from './wire';
import { fetch_data } from './token';

const rest_after = 300; // [ms] without a change

export class WorldView {
  readonly element = h('div', { class: 'world' });
  readonly canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': 'World: arrow keys turn, plus and minus zoom, click or Tab in the tree selects' });
  readonly eye: Eye;
  world: WorldScene | null = null;
  frames = 0;
  private readonly notice = h('div', { class: 'notice', role: 'status' });
  private renderer: WebGLRenderer | null = null;
  private scene = new Scene();
  private daylight = new Daylight(this.scene);
  readonly ranges = new Ranges(() => this.redraw());
  readonly contacts = new Contacts(this.scene, () => this.redraw());
  readonly axes = new Frames(this.scene);
  readonly trails = new Trails(this.scene);
  readonly ghosts = new Ghosts(this.scene, () => this.redraw());
  readonly hands: Hands;
  private marker = new Marker(this.scene);
  private labels = new Labels();
  private dirty = true;
  private shadows_dirty = true;
  private loading = -1;
  private loads = 0; // how many were begun
  private failed_version = -1;
  private bounds = new Box3();
  private restored = false;
  // Where a picture is dear (no GPU), pictures get fewer and shadows older, and the page stays quick.
  readonly pace = new Pace();
  private readonly backdrop = new Backdrop(this.scene);
  private next_draw = 0;
  private shadows_at = 0;
  // Pixels of a picture across, as a share of all: fewer, and coarse shadows, while things move where a picture is dear; all once they rest.
  private share = this.pace.share;
  private is_rough = true; // less than all pixels and shadows
  private rests_at = 0;

  constructor() {
    this.element.append(this.canvas, this.labels.element, this.notice);
    this.eye = new Eye(this.canvas, () => this.redraw(), (event) => !this.hands.begin_drag(event));
    this.hands = new Hands(this, this.scene);
    try {
      this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true, powerPreference: 'high-performance' });
      this.renderer.shadowMap.enabled = true;
      this.renderer.shadowMap.type = PCFSoftShadowMap;
      this.renderer.shadowMap.autoUpdate = false;
    } catch {
      this.say(`This browser has no WebGL 2, so the world is not drawn. Everything else works${has_run() ? '.' : '; `simctl screenshot` shows the world.'}`);
    }
    new ResizeObserver(() => this.resize()).observe(this.element);
    on(['world', 'status', 'hello'], () => this.follow_server());
    on('selection', () => this.redraw());
    on('settings', () => this.apply_settings());
    wire.on('poses', (poses) => this.take(poses));
    wire.on('late', () => this.show_late());
    const loop = () => {
      requestAnimationFrame(loop);
      const now = performance.now();
      if (this.element.offsetParent === null) return;
      if (this.dirty && now >= this.next_draw) {
        this.draw();
        this.next_draw = now + this.cost;
        this.rests_at = now + rest_after;
      } else if (!this.dirty && this.is_rough && now >= this.rests_at) {
        this.draw(true);
      }
    };
    requestAnimationFrame(loop);
  }

  redraw(): void {
    this.dirty = true;
  }

  private say(text: string, ...more: HTMLElement[]): void {
    put(this.notice, text ? h('div', { class: 'card' }, h('p', null, ...with_code(text)), more) : null);
  }

  private follow_server(): void {
    const { world } = store;
    this.element.classList.toggle('stale', (wire.status !== 'open' && wire.status !== 'connecting') || (world !== null && !world.present));
    if (!this.renderer) return;
    if (wire.status !== 'open') return this.say(`${link_problem()}${this.world ? ' The last known state is shown.' : ''}`);
    if (!world || !world.present) {
      this.failed_version = -1;
      const why = world?.problem || 'No simulator is running.';
      if (store.hello?.recording) return this.say(`${capital(why)} ${world?.is_coming ? '' : 'The rest of the recording is available.'}`);
      return this.say(`${capital(why)} Start one${store.hello?.start ? `: \`${store.hello.start.simulator}\`` : ''}. It appears here automatically.`);
    }
    if (this.world?.version === world.version && this.world_key === this.key_of()) return this.say('');
    this.load(world.version);
  }

  private world_key = '';
  private key_of(): string {
    return `${store.hello?.recording?.file}|${store.world?.server_id}|${store.world?.birth}|${settings.collisions}`;
  }

  private async load(version: number): Promise<void> {
    if (this.loading === version && this.world_key === this.key_of()) return;
    if (this.failed_version === version && this.world_key === this.key_of()) return;
    this.loading = version;
    this.world_key = this.key_of();
    const number = ++this.loads;
    try {
      const world = await this.fetch_world(version);
      if (number !== this.loads) return; // a newer one is on its way
      this.show(world);
      this.say('');
    } catch (error) {
      if (number !== this.loads) return;
      this.failed_version = version;
      this.say(`The world cannot be shown: ${(error as Error).message}`, button('Try again', { label: 'Try again' }, () => {
        this.failed_version = -1;
        this.load(store.world?.version ?? 0);
      }));
    } finally {
      if (number === this.loads) this.loading = -1;
    }
  }

  private async fetch_world(version: number): Promise<WorldScene> {
    const octets = settings.collisions ? null : await this.early;
    this.early = null;
    const world = octets && (await read_world(octets));
    if (world && world.version === version) return world;
    const reply = await fetch_data(`world.glb?v=${version}${settings.collisions ? '&collisions=1' : ''}`);
    if (!reply.ok) throw new Error((await reply.text()).slice(0, 200) || `world.glb: ${reply.status}`);
    return read_world(await reply.arrayBuffer());
  }

  // Which world it is, whatever is in it.
  private run_key = '';

  private show(world: WorldScene): void {
    const is_first = this.world === null;
    if (this.world) this.drop(this.world);
    const run = `${store.hello?.recording?.file}|${store.world?.server_id}|${store.world?.birth}`;
    if (run !== this.run_key) {
      this.trails.forget();
      this.ranges.forget();
    }
    this.run_key = run;
    this.trails.keep(new Set(world.models.keys()));
    this.world = world;
    this.is_past = false;
    this.present = null;
    this.ranges.show_at(null);
    this.trails.show(null);
    this.scene.add(world.root);
    this.scene.background = linear(world.look.background);
    this.measure();
    this.daylight.set(world, this.bounds);
    this.backdrop.set(world, this.daylight.parts());
    this.latecomers.begin(world);
    this.show_late();
    this.apply_all();
    this.apply_settings();
    if (is_first && !this.restored) this.whole();
    else this.look_again();
    changed('settings');
    changed('scene');
    this.shadows_dirty = true;
    this.redraw();
  }

  private readonly latecomers = new Latecomers();
  private show_late(): void {
    if (!this.world || store.late?.version !== this.world.version) return;
    this.latecomers.show(this.world, store.late);
    this.backdrop.forget();
    this.shadows_dirty = true;
    this.redraw();
  }

  private drop(world: WorldScene): void {
    this.ranges.clear();
    this.scene.remove(world.root);
    world.root.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      part.geometry.dispose();
      (part.material as ShaderMaterial).dispose();
    });
  }

  // What stands on the ground.
  private measure(): void {
    this.bounds.makeEmpty();
    this.world!.root.updateMatrixWorld(true);
    this.world!.root.traverse((part) => {
      if (!(part instanceof Mesh) || part.userData.ground) return;
      if (part instanceof SkinnedMesh) part.computeBoundingBox(); // with its bones where they are
      this.bounds.union(new Box3().copy(part instanceof SkinnedMesh ? part.boundingBox! : part.geometry.boundingBox!).applyMatrix4(part.matrixWorld));
    });
    if (this.bounds.isEmpty()) this.bounds.set(new Vector3(-3, -3, 0), new Vector3(3, 3, 1));
  }

  // Asked for before the server has said what it has: most often this is it.
  private early: Promise<ArrayBuffer | null> | null = fetch_data('world.glb').then((reply) => (reply.ok ? reply.arrayBuffer() : null), () => null);
  // The newest of each link that the server has told, by what stands where in which frame: a scene may come long after they did.
  private told = new Map<number, { view: DataView; at: number }>();
  private told_version = -1;
  private told_time = 0; // [s]
  is_past = false;
  private present: Float32Array | null = null;
  private take(poses: Poses): void {
    if (poses.all || poses.version !== this.told_version) this.told.clear();
    this.told_version = poses.version;
    this.told_time = poses.time;
    const { view } = poses;
    const is_shown = this.world?.version === poses.version;
    for (let i = 0, at = 24; i < poses.count; ++i, at += 24) {
      const index = view.getUint32(at, true);
      this.told.set(index, { view, at });
      if (is_shown) this.place(index, view, at);
    }
    if (is_shown) this.after_places();
  }
  private apply_all(): void {
    if (this.told_version !== this.world?.version) return;
    for (const [index, { view, at }] of this.told) this.place(index, view, at);
    this.after_places();
  }

  // Seven numbers a link: where they are now, also while what was is shown.
  places(): Float32Array {
    if (this.present) return this.present.slice();
    const links = this.world?.links ?? [];
    const places = new Float32Array(links.length * 7);
    links.forEach(({ position: p, quaternion: q }, i) => places.set([p.x, p.y, p.z, q.x, q.y, q.z, q.w], 7 * i));
    return places;
  }

  // Of the links, in their order; the same array as long as the scene is the same.
  link_names(): string[] {
    if (!this.world) return [];
    return (this.world.root.userData.link_names ??= this.world.links.map((link) => link.name));
  }

  // What was of the links with these names: in the order of now. A link that was not there is far away.
  private in_order(places: Float32Array, names: string[]): Float32Array {
    if (names === this.link_names()) return places;
    const before = new Map(names.map((name, i) => [name, i]));
    const ordered = new Float32Array(this.link_names().length * 7);
    this.link_names().forEach((name, i) => {
      const at = before.get(name);
      ordered.set(at === undefined ? [0, 0, -1e4, 0, 0, 0, 1] : places.subarray(7 * at, 7 * at + 7), 7 * i);
    });
    return ordered;
  }

  // Seven numbers a link: what was, of links with these names. Null: what is.
  // `moment`: when that was [s].
  show_past(was: Float32Array | null, names = this.link_names(), moment: number | null = null): void {
    const links = this.world?.links ?? [];
    const places = was && this.in_order(was, names);
    if (places && !this.is_past) this.present = this.places();
    const shown = places ?? this.present;
    this.is_past = places !== null;
    this.ranges.show_at(this.is_past ? moment : null);
    this.trails.show(this.is_past ? moment : null);
    if (!places) this.present = null;
    if (!shown || shown.length !== links.length * 7) return;
    links.forEach((link, i) => {
      link.position.fromArray(shown, 7 * i);
      link.quaternion.fromArray(shown, 7 * i + 3);
      this.backdrop.see(link);
    });
    this.shadows_dirty = true;
    this.redraw();
  }

  private place(index: number, view: DataView, at: number): void {
    const link = this.world!.links[index];
    if (!link) return;
    if (this.present) {
      const q = [16, 18, 20, 22].map((k) => view.getInt16(at + k, true) / 32767);
      this.present.set([view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true), ...q], 7 * index);
      return;
    }
    link.position.set(view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true));
    link.quaternion.set(view.getInt16(at + 16, true), view.getInt16(at + 18, true), view.getInt16(at + 20, true), view.getInt16(at + 22, true)).normalize();
    this.backdrop.see(link);
  }

  private after_places(): void {
    this.trails.lengthen(this.movers_now(), this.told_time);
    if (this.is_past) return;
    this.shadows_dirty = true;
    this.redraw();
  }

  // ---- what is laid over the world ----

  private apply_settings(): void {
    if (!this.world) return this.redraw();
    if (this.world_key !== this.key_of() && store.world?.present) return void this.load(store.world.version);
    this.ranges.show(this.world);
    this.trails.apply_settings();
    this.redraw();
  }

  private movers(): Model[] {
    const models = new Set(store.world?.ifaces.filter((i) => i.type.startsWith('position')).map((i) => i.model));
    return [...(this.world?.models.values() ?? [])].filter((m) => models.has(m.name));
  }

  // Also while the past is shown.
  private movers_now(): Mover[] {
    const { present } = this, links = this.world?.links ?? [];
    return this.movers().filter((m) => m.canonical).map(({ name, canonical }) => {
      const at = present ? links.indexOf(canonical!) : -1;
      return { name, position: present && at >= 0 ? new Vector3().fromArray(present, 7 * at) : canonical!.position };
    });
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width < 2 || height < 2 || !this.renderer) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio) * this.share);
    this.renderer.setSize(width, height, false);
    this.eye.resize(width, height);
    this.redraw();
  }

  private set_share(share: number): void {
    if (share === this.share || !this.renderer) return;
    if ((share === 1) !== (this.share === 1)) {
      this.daylight.set_fine(share === 1);
      this.shadows_dirty = true;
      this.shadows_at = -1e9;
    }
    this.share = share;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio) * share);
  }

  // At once; `is_whole`: with shadows as they are now, and every pixel.
  draw(is_whole = false): void {
    this.dirty = false;
    if (!this.renderer || !this.world) return;
    const { clientWidth: width, clientHeight: height } = this.element;
    this.world.root.updateMatrixWorld();
    this.ghosts.world?.root.updateMatrixWorld();
    this.eye.update();
    const { camera } = this.eye;
    camera.updateMatrixWorld();
    place_lights(this.world.look, this.world.lights);
    this.marker.draw(this.eye.mode === 'fixed' ? undefined : this.world.models.get(selected_model() ?? ''));
    this.hands.show_gizmo(!this.is_past && (this.eye.mode === 'orbit' || this.eye.mode === 'follow' || this.eye.mode === 'top'));
    const spots = this.axes.draw(this.world, selected_model());
    this.daylight.look_from(camera, this.eye.mode !== 'top');
    this.draw_scene(camera, is_whole);
    this.labels.draw(this.movers(), spots, camera, width, height);
    this.frames += 1;
    if (this.frames === 1) performance.mark('first-picture');
  }

  private draw_scene(camera: Camera, is_whole: boolean): void {
    const has_backdrop = this.backdrop.stands(camera) && !is_whole && this.pace.is_dear;
    this.pace.begin(has_backdrop);
    this.set_share(is_whole ? 1 : this.pace.share);
    this.is_rough = has_backdrop || this.share < 1;
    if (has_backdrop && this.backdrop.renew(this.renderer!, camera)) this.shadows_at = -1e9; // of what stands still alone
    const is_measured = this.pace.is_measured(is_whole);
    if (is_measured) this.wait_for_picture(); // what the browser draws meanwhile is not the cost of this one
    const began = performance.now();
    if (has_backdrop) this.backdrop.draw(this.renderer!, camera);
    else this.draw_all(camera, began, is_whole);
    if (!is_measured) return;
    this.wait_for_picture();
    this.pace.take(performance.now() - began, this.share);
  }

  private draw_all(camera: Camera, now: number, is_whole: boolean): void {
    if (is_whole || (this.shadows_dirty && now - this.shadows_at >= 4 * this.cost)) {
      this.renderer!.shadowMap.needsUpdate = true;
      this.shadows_dirty = false;
      this.shadows_at = now;
    }
    this.renderer!.render(this.scene, camera);
    if (this.shadows_dirty) setTimeout(() => this.redraw(), 4 * this.cost);
  }

  private wait_for_picture(): void {
    const gl = this.renderer!.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  private get cost(): number {
    return this.pace.cost(this.share);
  }

  // The eye as `simctl screenshot` has it: place and orientation of one that looks along x with z up, and its angle or, from above, its width.
  eye_pose(): { pose: number[]; span: number; top: boolean; width: number; height: number } {
    this.eye.update();
    const { camera, target, span, mode } = this.eye;
    const { clientWidth: width, clientHeight: height } = this.element;
    if (mode === 'top') return { pose: [target.x, target.y, 0, 1, 0, 0, 0], span, top: true, width, height };
    const turn = camera.quaternion.clone().multiply(to_ours.clone().invert());
    return { pose: [...camera.position.toArray(), turn.w, turn.x, turn.y, turn.z], span: this.eye.angle, top: false, width, height };
  }

  // ---- views ----

  // Obliquely from the south-west, as near as all corners fit into the picture: the view of `simctl screenshot`.
  whole(): void {
    const middle = this.bounds.getCenter(new Vector3());
    const aspect = this.element.clientWidth / Math.max(1, this.element.clientHeight);
    const direction = new Vector3(-0.35, -0.8, 0.62).normalize();
    const right = new Vector3(0, 0, 1).cross(direction).normalize(), up = direction.clone().cross(right);
    const wide = Math.tan(0.5) * 0.96, high = (Math.tan(0.5) / aspect) * 0.94;
    let distance = 0.5;
    for (let corner = 0; corner < 8; ++corner) {
      const at = new Vector3(corner & 1 ? this.bounds.max.x : this.bounds.min.x, corner & 2 ? this.bounds.max.y : this.bounds.min.y, corner & 4 ? this.bounds.max.z : this.bounds.min.z).sub(middle);
      distance = Math.max(distance, at.dot(direction) + Math.abs(at.dot(right)) / wide, at.dot(direction) + Math.abs(at.dot(up)) / high);
    }
    this.eye.orbit_from(middle.clone().addScaledVector(direction, distance), middle);
    const size = this.bounds.getSize(new Vector3());
    this.eye.span = Math.max(size.x, size.y * aspect, 1) * 1.06;
  }

  top(): void {
    this.whole();
    const { span } = this.eye;
    this.eye.set_mode('top');
    this.eye.span = span;
    this.redraw();
  }

  follow(name: string): void {
    const model = this.world?.models.get(name);
    if (!model?.canonical) return;
    const x = new Vector3(1, 0, 0).applyQuaternion(model.canonical.quaternion);
    this.eye.azimuth = Math.atan2(x.y, x.x) + Math.PI;
    this.eye.elevation = 0.5;
    this.eye.distance = Math.max(1.5, model.radius * 7);
    this.eye.set_mode('follow', name, model.canonical);
  }

  look_through(iface: string): void {
    const sensor = this.world?.sensors.find((s) => s.iface === iface && s.fov !== undefined);
    if (!sensor) return;
    sensor.node.userData.fov = sensor.fov;
    this.eye.set_mode('sensor', iface, sensor.node);
  }

  cameras(): string[] {
    return [...new Set(this.world?.sensors.filter((s) => s.fov !== undefined).map((s) => s.iface))];
  }

  // As a link holds it; what it follows or looks through is found when the world is there.
  restore(state: EyeState): void {
    this.eye.restore(state);
    this.restored = true;
  }

  // The parts of another scene are others: what was followed is looked for anew.
  private look_again(): void {
    const { eye } = this;
    if (eye.mode === 'sensor' && eye.what) this.look_through(eye.what);
    if (eye.mode !== 'follow') return;
    const canonical = this.world?.models.get(eye.what)?.canonical ?? null;
    if (canonical) eye.set_mode('follow', eye.what, canonical);
    else eye.set_mode('orbit');
  }
}

const capital = (text: string): string => {
  const line = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(line) ? line : `${line}.`;
};
