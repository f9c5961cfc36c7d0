// Where the selected model touches others: a cross at each contact, and its normal with half a metre. Asked for while they are to be seen.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Scene, Vector3 } from 'three';
import { recording } from './playback';
import { settings } from './settings';
import { selected_model, store, wire } from './store';

interface Contact { position: number[]; normal: number[] }

const period = 150; // [ms]
const arm = 0.06, normal_length = 0.5; // [m]

export class Contacts {
  count = 0;
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0xd6336c, depthTest: false, transparent: true }));
  private is_asked = false;

  constructor(scene: Scene, private readonly redraw: () => void) {
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 11;
    this.lines.userData.overlay = true;
    this.lines.visible = false;
    scene.add(this.lines);
    setInterval(() => this.look(), period);
  }

  private async look(): Promise<void> {
    const model = selected_model();
    if (!settings.contacts || !model || recording() || !store.world?.present || wire.status !== 'open') return this.show([]);
    if (this.is_asked) return;
    this.is_asked = true;
    try {
      this.show((await wire.request('contacts', { model })).result.contacts ?? []);
    } catch {
      this.show([]); // the model was deleted, or the simulator exited
    } finally {
      this.is_asked = false;
    }
  }

  private show(contacts: Contact[]): void {
    if (contacts.length === 0 && this.count === 0) return;
    this.count = contacts.length;
    this.lines.visible = contacts.length > 0;
    const points: number[] = [];
    for (const { position, normal } of contacts) {
      const at = new Vector3(...(position as [number, number, number]));
      for (const way of [new Vector3(arm, 0, 0), new Vector3(0, arm, 0), new Vector3(0, 0, arm)]) points.push(...at.clone().sub(way).toArray(), ...at.clone().add(way).toArray());
      points.push(...at.toArray(), ...at.clone().addScaledVector(new Vector3(...(normal as [number, number, number])), normal_length).toArray());
    }
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.redraw();
  }
}
