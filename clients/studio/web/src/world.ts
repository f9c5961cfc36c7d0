// The world: drawn here from one export of the simulator, moved by streamed poses.
import {
  Box3, BufferAttribute, BufferGeometry, Color, ConeGeometry, DirectionalLight, DoubleSide, Line, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Object3D, PCFSoftShadowMap, Plane, PlaneGeometry,
  Quaternion, Raycaster, Scene, ShaderMaterial, Sphere, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { Contacts } from './contacts';
import { button, h, put } from './dom';
import { Model, read_world, Sensor, WorldScene } from './glb';
import { linear, place_lights, sky_material, suns_of } from './material';
import { Eye } from './orbit';
import { act, changed, iface_id, link_problem, on, read_only, select, selected_model, store, wire } from './store';
import { settings } from './settings';
import type { Poses, Values } from './wire';
import { watch } from './watches';

export const palette = ['#3a7be0', '#3aa655', '#e08a2a', '#b455c8', '#22a7a7', '#d6506a', '#8a8f2a', '#7a6ae0'];

// What a range finder measures: the fan of a laser, or a cone for each sonar of a ring.
interface Fan { parts: (Mesh | Line)[]; iface: string; stop: () => void; sensors: Sensor[] }
interface Trail { line: Line; points: Float32Array; count: number; last: Vector3 }

export type Tool = 'look' | 'move' | 'push';
const trail_length = 4000;

// Along x, one metre long and one wide at its end: scaled by what is measured.
const cone = new ConeGeometry(1, 1, 24, 1, true).rotateZ(Math.PI / 2).translate(0.5, 0, 0);

export class WorldView {
  readonly element = h('div', { class: 'world' });
  readonly canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': 'World: arrow keys turn, plus and minus zoom, click or Tab in the tree selects' });
  readonly eye: Eye;
  tool: Tool = 'look';
  world: WorldScene | null = null;
  frames = 0;
  private readonly labels = h('div', { class: 'labels', 'aria-hidden': 'true' });
  private readonly notice = h('div', { class: 'notice', role: 'status' });
  private renderer: WebGLRenderer | null = null;
  private scene = new Scene();
  private sun = new DirectionalLight();
  readonly contacts = new Contacts(this.scene, () => this.redraw());
  private sky: { mesh: Mesh; material: ShaderMaterial } | null = null;
  private marker = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0xf2a516, depthTest: false, transparent: true }));
  private arrow = new Line(new BufferGeometry(), new LineBasicMaterial({ color: 0xe0452a, depthTest: false, transparent: true }));
  private fans = new Map<string, Fan>();
  private trails = new Map<string, Trail>();
  private names = new Map<string, HTMLElement>();
  private dirty = true;
  private shadows_dirty = true;
  private loading = -1;
  private failed_version = -1;
  private bounds = new Box3();
  private drag: { model: Model; at: Vector3; offset: Vector3; yaw: number; last: number; start: [number, number] } | null = null;
  private restored = false;
  // Of a picture [ms], by a look now and then. Where it is dear (no GPU), pictures get fewer and shadows older, and the page stays quick.
  private cost = 0;
  private next_draw = 0;
  private shadows_at = 0;

  constructor() {
    this.element.append(this.canvas, this.labels, this.notice);
    this.eye = new Eye(this.canvas, () => this.redraw(), (event) => !this.begin_drag(event));
    try {
      this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true, powerPreference: 'high-performance' });
      this.renderer.shadowMap.enabled = true;
      this.renderer.shadowMap.type = PCFSoftShadowMap;
      this.renderer.shadowMap.autoUpdate = false;
    } catch {
      this.say('This browser draws no 3D (WebGL 2 is off). Everything else works; `simctl screenshot` shows the world.');
    }
    this.sun.castShadow = true;
    this.scene.add(this.sun, this.sun.target, this.marker, this.arrow);
    this.marker.renderOrder = this.arrow.renderOrder = 10;
    this.marker.visible = this.arrow.visible = false;
    new ResizeObserver(() => this.resize()).observe(this.element);
    on(['world', 'status', 'hello'], () => this.follow_server());
    on('selection', () => this.redraw());
    on('settings', () => this.apply_settings());
    wire.on('poses', (poses) => this.take(poses));
    this.listen();
    const loop = () => {
      requestAnimationFrame(loop);
      const now = performance.now();
      if (this.dirty && now >= this.next_draw && this.element.offsetParent !== null) {
        this.draw();
        this.next_draw = now + 2 * this.cost;
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
    if (wire.status !== 'open') return this.say(`${link_problem()}${this.world ? ' This is what was last seen.' : ''}`);
    if (!world || !world.present) {
      const why = world?.problem || 'No simulator runs.';
      if (store.hello?.recording) return this.say(`${capital(why)} ${world?.is_coming ? '' : 'The rest of the recording can be looked at.'}`);
      return this.say(`${capital(why)} Start one: \`sim-server worlds/obstacle_course.sdf\`. It appears here by itself.`);
    }
    if (this.world?.version === world.version && this.world_key === this.key_of()) return this.say('');
    this.load(world.version);
  }

  private world_key = '';
  private key_of(): string {
    return `${store.world?.server_id}|${store.world?.name}|${settings.collisions}`;
  }

  private async load(version: number): Promise<void> {
    if (this.loading === version && this.world_key === this.key_of()) return;
    if (this.failed_version === version && this.world_key === this.key_of()) return;
    this.loading = version;
    const key = this.key_of();
    this.world_key = key;
    try {
      const world = await this.fetch_world(version);
      if (key !== this.world_key) return;
      this.show(world);
      this.say('');
    } catch (error) {
      this.failed_version = version;
      this.say(`The world cannot be shown: ${(error as Error).message}`, button('Try again', { label: 'Try again' }, () => {
        this.failed_version = -1;
        this.load(store.world?.version ?? 0);
      }));
    } finally {
      this.loading = -1;
    }
  }

  private async fetch_world(version: number): Promise<WorldScene> {
    const octets = settings.collisions ? null : await this.early;
    this.early = null;
    const world = octets && (await read_world(octets));
    if (world && world.version === version) return world;
    const reply = await fetch(`world.glb?v=${version}${settings.collisions ? '&collisions=1' : ''}`);
    if (!reply.ok) throw new Error((await reply.text()).slice(0, 200) || `world.glb: ${reply.status}`);
    return read_world(await reply.arrayBuffer());
  }

  private show(world: WorldScene): void {
    const is_first = this.world === null;
    if (this.world) this.drop(this.world);
    this.world = world;
    this.scene.add(world.root);
    this.scene.background = linear(world.look.background);
    this.measure();
    this.set_sun();
    this.set_sky();
    if (this.pending && this.pending.version === world.version) this.apply(this.pending);
    this.apply_settings();
    if (is_first && !this.restored) this.whole();
    changed('settings');
    changed('scene');
    this.shadows_dirty = true;
    this.redraw();
  }

  private drop(world: WorldScene): void {
    for (const name of [...this.fans.keys()]) this.remove_fan(name);
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
      if (part instanceof Mesh && !part.userData.ground) this.bounds.expandByObject(part);
    });
    if (this.bounds.isEmpty()) this.bounds.set(new Vector3(-3, -3, 0), new Vector3(3, 3, 1));
  }

  private set_sun(): void {
    const world = this.world!;
    place_lights(world.look, world.lights);
    const sun = suns_of(world.lights)[0];
    this.sun.castShadow = Boolean(sun?.extras.casts_shadow && world.look.shadows);
    if (!sun) return;
    const sphere = this.bounds.getBoundingSphere(new Sphere());
    const radius = Math.min(60, sphere.radius);
    const direction = new Vector3(0, 0, -1).transformDirection(sun.node.matrixWorld);
    this.sun.target.position.copy(sphere.center);
    this.sun.position.copy(sphere.center).addScaledVector(direction, -radius * 2);
    const { camera } = this.sun.shadow;
    camera.left = camera.bottom = -radius;
    camera.right = camera.top = radius;
    camera.near = 0.1;
    camera.far = radius * 4;
    camera.updateProjectionMatrix();
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0002;
    this.sun.shadow.normalBias = (3 * radius) / 2048;
    this.sun.shadow.radius = 1.5;
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
  }

  private set_sky(): void {
    if (this.sky) this.scene.remove(this.sky.mesh);
    this.sky = null;
    const material = sky_material(this.world!.look, this.world!.lights);
    if (!material) return;
    const mesh = new Mesh(new PlaneGeometry(2, 2), material);
    mesh.frustumCulled = false;
    mesh.renderOrder = -10;
    this.scene.add(mesh);
    this.sky = { mesh, material };
  }

  // Asked for before the server has said what it has: most often this is it.
  private early: Promise<ArrayBuffer | null> | null = fetch('world.glb').then((reply) => (reply.ok ? reply.arrayBuffer() : null), () => null);
  private pending: Poses | null = null;
  is_past = false;
  private present: Float32Array | null = null;
  private take(poses: Poses): void {
    if (poses.all) this.pending = poses;
    if (this.world && poses.version === this.world.version) this.apply(poses);
  }

  // Seven numbers a link: what was. Null: what is.
  show_past(places: Float32Array | null): void {
    const links = this.world?.links ?? [];
    if (places && !this.is_past) {
      this.present = new Float32Array(links.length * 7);
      links.forEach(({ position: p, quaternion: q }, i) => this.present!.set([p.x, p.y, p.z, q.x, q.y, q.z, q.w], 7 * i));
    }
    const shown = places ?? this.present;
    this.is_past = places !== null;
    if (!places) this.present = null;
    if (!shown || shown.length !== links.length * 7) return;
    links.forEach((link, i) => {
      link.position.fromArray(shown, 7 * i);
      link.quaternion.fromArray(shown, 7 * i + 3);
    });
    for (const fan of this.fans.values()) for (const part of fan.parts) part.visible = !this.is_past;
    this.shadows_dirty = true;
    this.redraw();
  }

  private apply(poses: Poses): void {
    const { view } = poses;
    const { links } = this.world!;
    for (let i = 0, at = 24; i < poses.count; ++i, at += 24) {
      const index = view.getUint32(at, true);
      const link = links[index];
      if (!link) continue;
      if (this.present) {
        const q = [16, 18, 20, 22].map((k) => view.getInt16(at + k, true) / 32767);
        this.present.set([view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true), ...q], 7 * index);
        continue;
      }
      link.position.set(view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true));
      link.quaternion.set(view.getInt16(at + 16, true), view.getInt16(at + 18, true), view.getInt16(at + 20, true), view.getInt16(at + 22, true)).normalize();
    }
    if (this.is_past) return;
    this.lengthen_trails();
    this.shadows_dirty = true;
    this.redraw();
  }

  // ---- what is laid over the world ----

  private apply_settings(): void {
    if (!this.world) return this.redraw();
    if (this.world_key !== this.key_of() && store.world?.present) return void this.load(store.world.version);
    const wanted = (store.world?.ifaces ?? []).filter((i) => (i.type === 'laser' && settings.lasers) || (i.type === 'sonar' && settings.sonars)).slice(0, 24);
    const names = new Set(wanted.map((i) => iface_id(i)));
    for (const name of [...this.fans.keys()]) if (!names.has(name)) this.remove_fan(name);
    wanted.forEach((iface, i) => {
      if (!this.fans.has(iface_id(iface))) this.add_fan(iface.name, iface.type, palette[i % palette.length]);
    });
    for (const trail of this.trails.values()) trail.line.visible = settings.trails;
    this.redraw();
  }

  private add_fan(name: string, type: string, color: string): void {
    const sensors = this.world!.sensors.filter((s) => s.iface === name);
    if (sensors.length === 0 || (type === 'laser' && sensors.length > 1)) return;
    const topic = store.signals.find((s) => s.kind === 'iface' && s.type.includes(type) && s.topic.endsWith('/' + name.replaceAll('::', '/')))?.topic ?? `/sim/${type}/${name.replaceAll('::', '/')}`;
    const fill = new MeshBasicMaterial({ color, transparent: true, opacity: type === 'sonar' ? 0.1 : 0.16, side: DoubleSide, depthWrite: false });
    const fan: Fan = { parts: [], iface: name, sensors, stop: () => {} };
    if (type === 'sonar') fan.parts = sensors.map(() => new Mesh(cone, fill));
    else fan.parts = [new Mesh(new BufferGeometry(), fill), new Line(new BufferGeometry(), new LineBasicMaterial({ color, transparent: true, opacity: 0.85 }))];
    fan.parts.forEach((part, i) => {
      part.frustumCulled = false;
      part.userData.overlay = true;
      part.renderOrder = 5;
      part.visible = type === 'laser';
      sensors[type === 'sonar' ? i : 0].node.add(part);
    });
    this.fans.set(`${type}:${name}`, fan);
    fan.stop = watch({ topic, hz: 15 }, (values) => (type === 'sonar' ? this.ring(fan, values) : this.scan(fan, values)));
  }

  private ring(fan: Fan, values: Values): void {
    const ranges = (values.value as { ranges?: number[] } | undefined)?.ranges ?? [];
    fan.parts.forEach((part, i) => {
      const { range_max: most = 5, radius = 0.5 } = fan.sensors[i] as unknown as { range_max?: number; radius?: number };
      const range = Math.min(ranges[i] ?? 0, most);
      part.visible = range > 0.01 && !this.is_past;
      part.scale.set(range, (radius / most) * range, (radius / most) * range);
    });
    this.redraw();
  }

  private scan(fan: Fan, values: Values): void {
    const sample = values.value as any;
    const ranges: number[] | undefined = sample?.ranges;
    if (!ranges?.length) return;
    const info = (store.world?.ifaces.find((i) => i.type === 'laser' && i.name === fan.iface)?.info ?? {}) as any;
    const sensor = fan.sensors[0];
    const from = sample.angle_min ?? info.min_angle ?? sensor.min_angle ?? -Math.PI / 2;
    const to = sample.angle_max ?? info.max_angle ?? sensor.max_angle ?? Math.PI / 2;
    const most = sample.range_max ?? info.max_range ?? sensor.range_max ?? 30;
    const beams = info.layers > 1 ? Math.floor(ranges.length / info.layers) : ranges.length;
    const points = new Float32Array((beams + 1) * 3);
    for (let i = 0; i < beams; ++i) {
      const angle = from + ((to - from) * i) / Math.max(1, beams - 1);
      const raw = ranges[i];
      const range = typeof raw === 'number' && Number.isFinite(raw) && raw > 0 ? Math.min(raw, most as number) : most as number;
      points[3 * i + 3] = range * Math.cos(angle);
      points[3 * i + 4] = range * Math.sin(angle);
    }
    const [area, edge] = fan.parts;
    const place = area.geometry;
    if (place.getAttribute('position')?.count !== beams + 1) {
      const index = new Uint16Array((beams - 1) * 3);
      for (let i = 0; i + 1 < beams; ++i) index.set([0, i + 1, i + 2], 3 * i);
      place.setIndex(new BufferAttribute(index, 1));
    }
    place.setAttribute('position', new BufferAttribute(points, 3));
    edge.geometry.setAttribute('position', new BufferAttribute(points.slice(3), 3));
    this.redraw();
  }

  private remove_fan(name: string): void {
    const fan = this.fans.get(name);
    if (!fan) return;
    fan.stop();
    for (const part of fan.parts) {
      part.removeFromParent();
      if (part.geometry !== cone) part.geometry.dispose();
    }
    this.fans.delete(name);
  }

  private movers(): Model[] {
    const models = new Set(store.world?.ifaces.filter((i) => i.type.startsWith('position')).map((i) => i.model));
    return [...(this.world?.models.values() ?? [])].filter((m) => models.has(m.name));
  }

  forget_trails(): void {
    for (const trail of this.trails.values()) {
      trail.count = 0;
      trail.last.set(1e9, 0, 0);
      trail.line.geometry.setDrawRange(0, 0);
    }
  }

  private lengthen_trails(): void {
    for (const model of this.movers()) {
      if (!model.canonical) continue;
      let trail = this.trails.get(model.name);
      if (!trail) {
        const points = new Float32Array(trail_length * 3);
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
      if (trail.count === trail_length) {
        trail.points.copyWithin(0, 3 * 400);
        trail.count -= 400;
      }
      trail.points.set([p.x, p.y, p.z + 0.02], 3 * trail.count++);
      trail.line.geometry.getAttribute('position').needsUpdate = true;
      trail.line.geometry.setDrawRange(0, trail.count);
    }
  }

  // The nearest first; a name that would lie on another one is left out, but for the chosen.
  private draw_names(width: number, height: number): void {
    const chosen = selected_model();
    const place = new Vector3();
    const spots: { name: string; x: number; y: number; far: number }[] = [];
    for (const model of settings.names ? this.movers() : []) {
      if (!model.canonical) continue;
      place.copy(model.canonical.position);
      place.z += model.height + 0.05;
      place.project(this.eye.camera);
      if (place.z > 1 || Math.abs(place.x) > 1.02 || Math.abs(place.y) > 1.02) continue;
      spots.push({ name: model.name, x: ((place.x + 1) / 2) * width, y: ((1 - place.y) / 2) * height, far: model.name === chosen ? -2 : place.z });
    }
    spots.sort((a, b) => a.far - b.far);
    const taken: { x: number; y: number; half: number }[] = [];
    const seen = new Set<string>();
    for (const { name, x, y } of spots) {
      const half = name.length * 3.2 + 5;
      if (taken.length >= 150 || taken.some((t) => Math.abs(t.y - y) < 17 && Math.abs(t.x - x) < t.half + half)) continue;
      taken.push({ x, y, half });
      seen.add(name);
      let label = this.names.get(name);
      if (!label) {
        label = h('span', null, name);
        this.labels.append(label);
        this.names.set(name, label);
      }
      label.classList.toggle('chosen', name === chosen);
      label.style.transform = `translate(${x}px,${y}px) translate(-50%,-100%)`;
    }
    for (const [name, label] of this.names) {
      if (seen.has(name)) continue;
      label.remove();
      this.names.delete(name);
    }
  }

  // The corners of a box round the selected model, turned with it.
  private draw_marker(): void {
    const model = this.world?.models.get(selected_model() ?? '');
    this.marker.visible = Boolean(model?.canonical) && this.eye.mode !== 'fixed';
    if (!model?.canonical || !this.marker.visible) return;
    const box = new Box3(), part_box = new Box3();
    const inverse = model.canonical.matrixWorld.clone().invert();
    for (const link of model.links) {
      link.traverse((part) => {
        if (!(part instanceof Mesh) || part.userData.overlay || part.userData.ground) return;
        part.geometry.boundingBox ?? part.geometry.computeBoundingBox();
        box.union(part_box.copy(part.geometry.boundingBox!).applyMatrix4(part.matrixWorld).applyMatrix4(inverse));
      });
    }
    if (box.isEmpty() || box.getSize(new Vector3()).length() > 80) return void (this.marker.visible = false);
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
    this.marker.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.marker.frustumCulled = false;
    this.marker.matrixAutoUpdate = false;
    this.marker.matrix.copy(model.canonical.matrixWorld);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width < 2 || height < 2 || !this.renderer) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.eye.resize(width, height);
    this.redraw();
  }

  // At once; `is_whole`: with shadows as they are now.
  draw(is_whole = false): void {
    this.dirty = false;
    if (is_whole) this.shadows_at = -1e9;
    if (!this.renderer || !this.world) return;
    const { clientWidth: width, clientHeight: height } = this.element;
    this.world.root.updateMatrixWorld();
    this.eye.update();
    const { camera } = this.eye;
    camera.updateMatrixWorld();
    place_lights(this.world.look, this.world.lights);
    this.draw_marker();
    if (this.sky) {
      this.sky.mesh.visible = this.eye.mode !== 'top';
      this.sky.material.uniforms.inverse_projection.value.copy(camera.projectionMatrixInverse);
      this.sky.material.uniforms.camera_world.value.copy(camera.matrixWorld);
    }
    const began = performance.now();
    if (this.shadows_dirty && began - this.shadows_at >= 4 * this.cost) {
      this.renderer.shadowMap.needsUpdate = true;
      this.shadows_dirty = false;
      this.shadows_at = began;
    }
    this.renderer.render(this.scene, camera);
    if (this.frames > 1 && this.frames % 16 === 2) this.measure_cost(began);
    if (this.shadows_dirty) setTimeout(() => this.redraw(), 4 * this.cost);
    this.draw_names(width, height);
    this.frames += 1;
    if (this.frames === 1) performance.mark('first-picture');
  }

  private measure_cost(began: number): void {
    const gl = this.renderer!.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits for the picture
    const cost = performance.now() - began;
    this.cost = cost < 6 ? 0 : Math.min(cost, 500);
  }

  // ---- views ----

  // Obliquely from the south-west, as near as all corners fit into the picture.
  whole(): void {
    const middle = this.bounds.getCenter(new Vector3());
    const aspect = this.element.clientWidth / Math.max(1, this.element.clientHeight);
    const direction = new Vector3(-0.35, -0.8, 0.62).normalize();
    const right = new Vector3(0, 0, 1).cross(direction).normalize(), up = direction.clone().cross(right);
    const wide = Math.tan(0.5) * 0.95, high = (Math.tan(0.5) / aspect) * 0.92;
    let distance = 1;
    for (let corner = 0; corner < 8; ++corner) {
      const at = new Vector3(corner & 1 ? this.bounds.max.x : this.bounds.min.x, corner & 2 ? this.bounds.max.y : this.bounds.min.y, corner & 4 ? this.bounds.max.z : this.bounds.min.z).sub(middle);
      distance = Math.max(distance, at.dot(direction) + Math.abs(at.dot(right)) / wide, at.dot(direction) + Math.abs(at.dot(up)) / high);
    }
    this.eye.orbit_from(middle.clone().addScaledVector(direction, distance), middle);
    const size = this.bounds.getSize(new Vector3());
    this.eye.span = Math.max(size.x, size.y * aspect) * 1.06;
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

  mark_restored(): void {
    this.restored = true;
  }

  // ---- the mouse on models ----

  private ray(event: { clientX: number; clientY: number }): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2), this.eye.camera as never);
    return ray;
  }

  private hit(event: { clientX: number; clientY: number }): { model: string; point: Vector3 } | null {
    if (!this.world) return null;
    const hits = this.ray(event).intersectObject(this.world.root, true);
    const found = hits.find(({ object }) => !object.userData.overlay && !object.userData.ground && object instanceof Mesh && model_name(object));
    return found ? { model: model_name(found.object)!, point: found.point } : null;
  }

  private on_plane(event: PointerEvent, z: number): Vector3 | null {
    return this.ray(event).ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -z), new Vector3());
  }

  private begin_drag(event: PointerEvent): boolean {
    if (this.tool === 'look' || event.button !== 0 || read_only()) return false;
    const hit = this.hit(event);
    const model = hit && this.world!.models.get(hit.model);
    if (!hit || !model?.canonical || model.is_static) return false;
    select({ kind: 'model', id: model.name });
    const x = new Vector3(1, 0, 0).applyQuaternion(model.canonical.getWorldQuaternion(new Quaternion()));
    this.drag = {
      model, at: hit.point.clone(), offset: model.canonical.position.clone().sub(hit.point), yaw: Math.atan2(x.y, x.x), last: 0, start: [event.clientX, event.clientY],
    };
    this.canvas.setPointerCapture(event.pointerId);
    return true;
  }

  private go_on(event: PointerEvent, is_end: boolean): void {
    const { drag } = this;
    if (!drag) return;
    const point = this.on_plane(event, drag.at.z);
    if (!point) return;
    if (this.tool === 'push') {
      this.arrow.visible = !is_end;
      this.arrow.geometry.setAttribute('position', new BufferAttribute(new Float32Array([...drag.at.toArray(), ...point.toArray()]), 3));
      this.arrow.frustumCulled = false;
      if (is_end) this.push(drag.model.name, point.sub(drag.at));
    } else if (is_end || event.timeStamp - drag.last > 80) {
      drag.last = event.timeStamp;
      if (event.altKey || event.ctrlKey) drag.yaw += (event.clientX - drag.start[0]) * 0.001;
      const place = point.add(drag.offset);
      const args = { model: drag.model.name, planar: [place.x, place.y, drag.yaw] };
      if (is_end) act(`Move ${drag.model.name}`, 'set_pose', args);
      else wire.request('set_pose', args).catch(() => {});
    }
    if (is_end) this.drag = null;
    this.redraw();
  }

  // 100 N for each metre of the arrow, for a fifth of a second.
  push(model: string, way: Vector3): void {
    if (way.length() < 0.02) return;
    const force = way.multiplyScalar(100).toArray().map((f) => Math.round(f));
    act(`Push ${model}`, 'push', { name: model, force, seconds: 0.2 });
  }

  set_tool(tool: Tool): void {
    this.tool = this.tool === tool ? 'look' : tool;
    this.element.dataset.tool = this.tool;
    changed('settings');
  }

  private listen(): void {
    let down: [number, number] | null = null;
    this.canvas.addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; });
    this.canvas.addEventListener('pointermove', (event) => this.go_on(event, false));
    this.canvas.addEventListener('pointerup', (event) => {
      if (this.drag) return this.go_on(event, true);
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4 || event.button !== 0) return;
      const hit = this.hit(event);
      select(hit ? { kind: 'model', id: hit.model } : null);
    });
    this.canvas.addEventListener('dblclick', (event) => {
      const hit = this.hit(event);
      if (hit) this.follow(hit.model);
    });
  }
}

function model_name(object: Object3D | null): string | undefined {
  return object ? (object.userData.model as string | undefined) ?? model_name(object.parent) : undefined;
}

const capital = (text: string): string => {
  const line = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(line) ? line : `${line}.`;
};

// `words` in backquotes become code.
export function with_code(text: string): (string | HTMLElement)[] {
  return text.split('`').map((part, i) => (i % 2 === 1 ? h('code', null, part) : part));
}

export const color_of = (css: string): Color => new Color(css);
