// Models that have come to a recorded world after its beginning, in one colour each as /sim/shapes has them; those that have gone are hidden.
import { Bone, BufferAttribute, BufferGeometry, Group, Matrix4, Mesh } from 'three';
import type { WorldScene } from './glb';
import { linear, make_material } from './material';
import type { Late } from './wire';

export class Latecomers {
  private came: string[] = [];
  private gone: string[] = [];
  private links = 0; // of the scene alone

  // A scene that has just been read.
  begin(world: WorldScene): void {
    this.came = [];
    this.gone = [];
    this.links = world.links.length;
  }

  show(world: WorldScene, late: Late): void {
    for (const name of this.gone) this.see(world, name, true);
    for (const name of this.came) this.remove(world, name);
    world.links.length = this.links;
    this.gone = late.gone;
    this.came = late.models.map(({ name }) => name);
    for (const name of this.gone) this.see(world, name, false);
    for (const model of late.models) this.add(world, model);
  }

  private see(world: WorldScene, name: string, is_seen: boolean): void {
    const model = world.models.get(name);
    if (model) model.group.visible = is_seen;
  }

  private remove(world: WorldScene, name: string): void {
    world.models.get(name)?.group.traverse((part) => {
      if (part instanceof Mesh) part.geometry.dispose();
    });
    world.models.get(name)?.group.removeFromParent();
    world.models.delete(name);
  }

  private add(world: WorldScene, { name, links }: Late['models'][0]): void {
    const group = new Group();
    let radius = 0;
    const bones = links.map((link) => {
      const bone = new Bone();
      bone.name = link.name;
      for (const { color, points } of link.parts) {
        const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
        geometry.computeVertexNormals();
        geometry.computeBoundingSphere();
        radius = Math.max(radius, geometry.boundingSphere?.radius ?? 0);
        const { r, g, b } = linear(color);
        const mesh = new Mesh(geometry, make_material({ pbrMetallicRoughness: { baseColorFactor: [r, g, b, color[3]] }, alphaMode: color[3] < 1 ? 'BLEND' : 'OPAQUE' }, false, [], world.look, world.lights));
        mesh.castShadow = mesh.receiveShadow = true;
        bone.add(mesh);
      }
      bone.traverse((part) => { part.userData.model = name; });
      group.add(bone);
      world.links.push(bone);
      return bone;
    });
    world.root.add(group);
    world.models.set(name, { name, group, links: bones, is_static: false, radius, height: radius, canonical: bones[0] ?? null, frame: new Matrix4() });
  }
}
