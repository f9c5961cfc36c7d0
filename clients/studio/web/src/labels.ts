// Names of robots, over them.
import { Camera, Vector3 } from 'three';
import { h } from './dom';
import type { Model } from './glb';
import { settings } from './settings';
import { selected_model } from './store';

export class Labels {
  readonly element = h('div', { class: 'labels', 'aria-hidden': 'true' });
  private names = new Map<string, HTMLElement>();

  // The nearest first; a name that would lie on another one is left out, but for the chosen.
  draw(models: Model[], camera: Camera, width: number, height: number): void {
    const chosen = selected_model();
    const place = new Vector3();
    const spots: { name: string; x: number; y: number; far: number }[] = [];
    for (const model of settings.names ? models : []) {
      if (!model.canonical) continue;
      place.copy(model.canonical.position);
      place.z += model.height + 0.05;
      place.project(camera);
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
        this.element.append(label);
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
}
