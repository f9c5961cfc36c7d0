// What stands still in the world, drawn once for an eye that stands still: while a run is played or scrubbed, a picture costs only what moves.
// For browsers without a GPU. What moves has no shadow on it, and gets shadows only from what stands still.
import { AlwaysDepth, Camera, DepthTexture, Material, Mesh, Object3D, PlaneGeometry, RGBAFormat, Scene, ShaderMaterial, SkinnedMesh, SRGBColorSpace, UnsignedIntType, Vector2, WebGLRenderer, WebGLRenderTarget } from 'three';
import type { WorldScene } from './glb';

const still_layer = 1; // besides that of all things

export class Backdrop {
  private still: Object3D[] = [];
  private places = new Map<Object3D, string>(); // of links that stand still
  private target: WebGLRenderTarget | null = null;
  private is_possible = false;
  private drawn_for = ''; // what the target holds
  private eye = '';
  private readonly sheet = new Mesh(new PlaneGeometry(2, 2), new ShaderMaterial({
    depthFunc: AlwaysDepth,
    uniforms: { colors: { value: null }, depths: { value: null } },
    vertexShader: 'varying vec2 place; void main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: 'varying vec2 place; uniform sampler2D colors; uniform highp sampler2D depths; void main() { gl_FragColor = texture2D(colors, place); gl_FragDepth = texture2D(depths, place).r; }',
  }));

  constructor(private readonly scene: Scene) {
    this.sheet.frustumCulled = false;
    this.sheet.renderOrder = -20;
    this.sheet.visible = false;
    scene.add(this.sheet);
  }

  // `others`: outside of the world, as its sky and its sun. Lights that move change what stands still: then there is no backdrop.
  set(world: WorldScene, others: Object3D[]): void {
    const moving = new Set<Object3D>([...world.models.values()].filter((model) => !model.is_static).flatMap((model) => model.links));
    const moves = (part: Object3D | null): boolean => part !== null && (moving.has(part) || moves(part.parent));
    this.is_possible = !world.lights.some(({ node }) => moves(node));
    this.still = others;
    world.root.traverse((part) => {
      if (!(part instanceof Mesh) || part instanceof SkinnedMesh || part.userData.overlay || (part.material as Material).transparent) return;
      if (!moves(part)) this.still.push(part);
    });
    this.places = new Map(world.links.filter((link) => !moving.has(link)).map((link) => [link, '']));
    for (const part of this.still) part.layers.enable(still_layer);
    this.forget();
  }

  // A link has been placed: one that stands still may have been put elsewhere.
  see(link: Object3D): void {
    const before = this.places.get(link);
    if (before === undefined) return;
    const place = [...link.position.toArray(), ...link.quaternion.toArray()].join();
    if (place === before) return;
    this.places.set(link, place);
    this.forget();
  }

  // What stands still has changed.
  forget(): void {
    this.drawn_for = '';
  }

  // Whether the eye is where it was at the last call.
  stands(camera: Camera): boolean {
    const eye = [...camera.projectionMatrix.elements, ...camera.matrixWorld.elements].join(), before = this.eye;
    this.eye = eye;
    return this.is_possible && eye === before;
  }

  // Before draw(). True: it was drawn anew, with shadow maps of what stands still alone.
  renew(renderer: WebGLRenderer, camera: Camera): boolean {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2()), key = `${this.eye}|${x}|${y}`;
    if (this.drawn_for === key) return false;
    this.drawn_for = key;
    this.target ??= this.make_target(x, y);
    if (this.target.width !== x || this.target.height !== y) this.target.setSize(x, y);
    const { mask } = camera.layers;
    camera.layers.set(still_layer);
    renderer.shadowMap.needsUpdate = true;
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, camera);
    renderer.setRenderTarget(null);
    camera.layers.mask = mask;
    return true;
  }

  private make_target(x: number, y: number): WebGLRenderTarget {
    const target = new WebGLRenderTarget(x, y, { colorSpace: SRGBColorSpace, format: RGBAFormat, internalFormat: 'RGBA8', samples: 4, depthTexture: new DepthTexture(x, y, UnsignedIntType) });
    (target as { isXRRenderTarget?: boolean }).isXRRenderTarget = true; // three.js writes into it as on the screen, with the same programs
    const { uniforms } = this.sheet.material as ShaderMaterial;
    uniforms.colors.value = target.texture;
    uniforms.depths.value = target.depthTexture;
    return target;
  }

  draw(renderer: WebGLRenderer, camera: Camera): void {
    const hidden = this.still.filter((part) => part.visible && part instanceof Mesh), { background } = this.scene;
    for (const part of hidden) part.visible = false;
    this.scene.background = null;
    this.sheet.visible = true;
    renderer.render(this.scene, camera);
    this.sheet.visible = false;
    this.scene.background = background;
    for (const part of hidden) part.visible = true;
  }
}
