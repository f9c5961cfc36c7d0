// The light that casts shadows, and the sky behind all.
import { Box3, Camera, DirectionalLight, Mesh, Object3D, PlaneGeometry, Scene, ShaderMaterial, Sphere, Vector3 } from 'three';
import type { WorldScene } from './glb';
import { place_lights, sky_material, suns_of } from './material';

export class Daylight {
  private sun = new DirectionalLight();
  private radius = 1;
  private map_size = 512; // pixels across; at first coarse (set_fine)
  private sky: { mesh: Mesh; material: ShaderMaterial } | null = null;

  constructor(private readonly scene: Scene) {
    this.sun.castShadow = true;
    scene.add(this.sun, this.sun.target);
  }

  // `bounds`: what stands on the ground, and so casts shadows.
  set(world: WorldScene, bounds: Box3): void {
    this.set_sun(world, bounds);
    this.set_sky(world);
  }

  private set_sun(world: WorldScene, bounds: Box3): void {
    place_lights(world.look, world.lights);
    const sun = suns_of(world.lights)[0];
    this.sun.castShadow = Boolean(sun?.extras.casts_shadow && world.look.shadows);
    if (!sun) return;
    const sphere = bounds.getBoundingSphere(new Sphere());
    const radius = this.radius = Math.min(60, sphere.radius);
    const direction = new Vector3(0, 0, -1).transformDirection(sun.node.matrixWorld);
    this.sun.target.position.copy(sphere.center);
    this.sun.position.copy(sphere.center).addScaledVector(direction, -radius * 2);
    const { camera } = this.sun.shadow;
    camera.left = camera.bottom = -radius;
    camera.right = camera.top = radius;
    camera.near = 0.1;
    camera.far = radius * 4;
    camera.updateProjectionMatrix();
    this.sun.shadow.bias = -0.0002;
    this.sun.shadow.radius = 1.5;
    this.renew_shadows();
  }

  // What hangs in the scene for it.
  parts(): Object3D[] {
    return this.sky ? [this.sun, this.sky.mesh] : [this.sun];
  }

  // Fine shadows cost more than all else where there is no GPU. The next picture needs new ones.
  set_fine(is_fine: boolean): void {
    this.map_size = is_fine ? 2048 : 512;
    this.renew_shadows();
  }

  private renew_shadows(): void {
    const { shadow } = this.sun;
    shadow.mapSize.set(this.map_size, this.map_size);
    shadow.normalBias = (3 * this.radius) / this.map_size;
    shadow.map?.dispose();
    shadow.map = null;
  }

  private set_sky(world: WorldScene): void {
    if (this.sky) this.scene.remove(this.sky.mesh);
    this.sky = null;
    const material = sky_material(world.look, world.lights);
    if (!material) return;
    const mesh = new Mesh(new PlaneGeometry(2, 2), material);
    mesh.frustumCulled = false;
    mesh.renderOrder = -10;
    this.scene.add(mesh);
    this.sky = { mesh, material };
  }

  // The sky as this camera sees it.
  look_from(camera: Camera, has_sky: boolean): void {
    if (!this.sky) return;
    this.sky.mesh.visible = has_sky;
    this.sky.material.uniforms.inverse_projection.value.copy(camera.projectionMatrixInverse);
    this.sky.material.uniforms.camera_world.value.copy(camera.matrixWorld);
  }
}
