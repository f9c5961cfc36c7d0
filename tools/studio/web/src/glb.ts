// Reads what `simctl export` writes: glTF 2.0 binary with one scene. z stays up; poses of links are in the world.
import {
  Bone, Box3, BufferAttribute, BufferGeometry, Group, LinearMipmapLinearFilter, LinearSRGBColorSpace, Matrix4, Mesh, Object3D, Quaternion, RepeatWrapping, Skeleton, SkinnedMesh, Sphere, SRGBColorSpace, Texture, Vector3,
} from 'three';
import { Look, make_material, SceneLight, Surface } from './material';

export interface Sensor { iface: string; kind: string; node: Object3D; [number: string]: unknown }
export interface Model { name: string; group: Group; links: Object3D[]; is_static: boolean; radius: number; height: number; canonical: Object3D | null; frame: Matrix4 }
export interface Pose { position: Vector3; quaternion: Quaternion }

// In the world. Links are what is told; a model's own frame hangs on its canonical link.
export function pose_of(model: Model): Pose {
  const pose = { position: new Vector3(), quaternion: new Quaternion() };
  model.canonical!.updateMatrix();
  new Matrix4().multiplyMatrices(model.canonical!.matrix, model.frame).decompose(pose.position, pose.quaternion, new Vector3());
  return pose;
}

export interface WorldScene {
  root: Group;
  links: Object3D[];
  models: Map<string, Model>;
  sensors: Sensor[];
  lights: SceneLight[];
  look: Look;
  version: number;
  grounds: Object3D[];
}

const arrays: { [type: number]: any } = { 5121: Uint8Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const sizes: { [type: string]: number } = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

interface File { json: any; binary: ArrayBuffer; offset: number }

function split(octets: ArrayBuffer): File {
  const head = new DataView(octets);
  if (octets.byteLength < 20 || head.getUint32(0, true) !== 0x46546c67) throw new Error('the world is no glTF binary');
  const length = head.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(octets, 20, length)));
  return { json, binary: octets, offset: 28 + length };
}

class Reader {
  readonly textures: (Texture | null)[] = [];
  private attributes = new Map<number, BufferAttribute>();
  private materials = new Map<string, Surface>();

  constructor(readonly file: File) {}

  view(index: number): { offset: number; length: number } {
    const view = this.file.json.bufferViews[index];
    return { offset: this.file.offset + (view.byteOffset ?? 0), length: view.byteLength };
  }

  array(index: number): any {
    const accessor = this.file.json.accessors[index];
    const { offset } = this.view(accessor.bufferView);
    return new arrays[accessor.componentType](this.file.binary, offset + (accessor.byteOffset ?? 0), accessor.count * sizes[accessor.type]);
  }

  attribute(index: number): BufferAttribute {
    let kept = this.attributes.get(index);
    if (!kept) {
      kept = new BufferAttribute(this.array(index), sizes[this.file.json.accessors[index].type]);
      this.attributes.set(index, kept);
    }
    return kept;
  }

  async load_textures(): Promise<void> {
    const { json } = this.file;
    const colours = new Set<number>();
    for (const material of json.materials ?? []) {
      for (const used of [material.pbrMetallicRoughness?.baseColorTexture, material.emissiveTexture]) if (used) colours.add(used.index);
    }
    await Promise.all((json.textures ?? []).map(async (entry: any, index: number) => {
      const image = json.images[entry.source];
      const { offset, length } = this.view(image.bufferView);
      const bitmap = await createImageBitmap(new Blob([new Uint8Array(this.file.binary, offset, length)], { type: image.mimeType }), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
      const texture = new Texture(bitmap);
      texture.flipY = false;
      texture.wrapS = texture.wrapT = RepeatWrapping;
      texture.minFilter = LinearMipmapLinearFilter;
      texture.anisotropy = 4;
      texture.colorSpace = colours.has(index) ? SRGBColorSpace : LinearSRGBColorSpace;
      texture.needsUpdate = true;
      this.textures[index] = texture;
    }));
  }

  material(index: number, has_grid: boolean, look: Look, lights: SceneLight[]): Surface {
    const key = `${index}|${has_grid}`;
    let kept = this.materials.get(key);
    if (!kept) {
      kept = make_material(this.file.json.materials[index], has_grid, this.textures, look, lights);
      this.materials.set(key, kept);
    }
    return kept;
  }

  geometry(primitive: any): BufferGeometry {
    const geometry = new BufferGeometry();
    const names: { [gltf: string]: string } = { POSITION: 'position', NORMAL: 'normal', TEXCOORD_0: 'uv', JOINTS_0: 'skinIndex', WEIGHTS_0: 'skinWeight' };
    for (const [gltf, accessor] of Object.entries(primitive.attributes)) geometry.setAttribute(names[gltf], this.attribute(accessor as number));
    geometry.setIndex(this.attribute(primitive.indices));
    bound(geometry);
    return geometry;
  }
}

// Parts of one mesh share their vertices: the bounds of a part are those of the vertices that it uses.
function bound(geometry: BufferGeometry): void {
  const points = geometry.getAttribute('position'), index = geometry.getIndex()!, at = new Vector3();
  geometry.boundingBox = new Box3();
  for (let i = 0; i < index.count; ++i) geometry.boundingBox.expandByPoint(at.fromBufferAttribute(points, index.getX(i)));
  geometry.boundingSphere = geometry.boundingBox.getBoundingSphere(new Sphere());
}

function place(object: Object3D, node: any): void {
  if (node.matrix) new Matrix4().fromArray(node.matrix).decompose(object.position, object.quaternion, object.scale);
  if (node.translation) object.position.fromArray(node.translation);
  if (node.rotation) object.quaternion.fromArray(node.rotation);
  if (node.scale) object.scale.fromArray(node.scale);
}

function shape(reader: Reader, node: any, look: Look, lights: SceneLight[]): Mesh {
  const primitive = reader.file.json.meshes[node.mesh].primitives[0];
  const material = reader.material(primitive.material, node.extras?.grid === true, look, lights);
  const geometry = reader.geometry(primitive);
  const mesh = node.skin === undefined ? new Mesh(geometry, material) : new SkinnedMesh(geometry, material);
  mesh.castShadow = node.extras?.casts_shadow === true && node.extras?.ground !== true;
  mesh.receiveShadow = true;
  mesh.userData.ground = node.extras?.ground === true;
  return mesh;
}

export async function read_world(octets: ArrayBuffer): Promise<WorldScene> {
  const file = split(octets);
  const { json } = file;
  const reader = new Reader(file);
  await reader.load_textures();
  const extras = json.scenes[0].extras;
  const look: Look = extras;
  const link_of = new Map<number, number>((extras.links as number[]).map((node, link) => [node, link]));
  const nodes: Object3D[] = [];
  const scene: WorldScene = {
    root: new Group(), links: [], models: new Map(), sensors: [], lights: [], look, version: extras.version, grounds: [],
  };
  // Lights first: materials are made for as many as there are.
  json.nodes.forEach((node: any, index: number) => {
    const light = node.extensions?.KHR_lights_punctual;
    if (!light) return;
    nodes[index] = new Object3D();
    place(nodes[index], node);
    scene.lights.push({ ...json.extensions.KHR_lights_punctual.lights[light.light], node: nodes[index] });
  });
  json.nodes.forEach((node: any, index: number) => {
    if (nodes[index]) return;
    const object = node.mesh !== undefined ? shape(reader, node, look, scene.lights)
      : link_of.has(index) ? new Bone() : new Group();
    if (index > 0) place(object, node);
    object.name = node.name ?? '';
    if (object instanceof Mesh && object.userData.ground) scene.grounds.push(object);
    if (node.extras?.iface) scene.sensors.push({ ...node.extras, node: object });
    nodes[index] = object;
  });
  json.nodes.forEach((node: any, index: number) => {
    for (const child of node.children ?? []) nodes[index].add(nodes[child]);
    if (node.skin === undefined) return;
    const skin = json.skins[node.skin];
    const matrices = reader.array(skin.inverseBindMatrices);
    const bones = skin.joints.map((joint: number) => nodes[joint] as Bone);
    const inverses = bones.map((_: Bone, i: number) => new Matrix4().fromArray(matrices, 16 * i));
    (nodes[index] as SkinnedMesh).bind(new Skeleton(bones, inverses), new Matrix4());
    nodes[index].frustumCulled = false;
  });
  scene.root = nodes[0] as Group;
  scene.links = (extras.links as number[]).map((node) => nodes[node]);
  json.nodes.forEach((node: any, index: number) => {
    if (!node.extras?.model) return;
    const links = (node.children ?? []).map((child: number) => nodes[child]);
    for (const link of links) link.traverse((part: Object3D) => { part.userData.model = node.name; });
    scene.models.set(node.name, {
      name: node.name, group: nodes[index] as Group, links, is_static: node.extras.static, radius: node.extras.radius, height: node.extras.height,
      canonical: scene.links[node.extras.link] ?? null,
      frame: new Matrix4().compose(new Vector3().fromArray(node.extras.position ?? [0, 0, 0]), new Quaternion().fromArray(node.extras.rotation ?? [0, 0, 0, 1]), new Vector3(1, 1, 1)),
    });
  });
  return scene;
}
