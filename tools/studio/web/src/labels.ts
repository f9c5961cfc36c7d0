// Names over the world: of robots, and of links where their frames are shown.
import { Camera, Vector3 } from 'three';
import { h } from './dom';
import type { Spot } from './frames';
import type { Model } from './glb';
import { settings } from './settings';
import { selected_model } from './store';

interface Seen { key: string; name: string; x: number; y: number; far: number }

export class Labels {
  readonly element = h('div', { class: 'labels', 'aria-hidden': 'true' });
  private names = new Map<string, HTMLElement>();

  // `frames`: names of links, where their frames are shown.
  draw(models: Model[], frames: Spot[], camera: Camera, width: number, height: number): void {
    const chosen = selected_model();
    const spots: Seen[] = [];
    const add = (key: string, name: string, place: Vector3, far?: number) => {
      place.project(camera);
      if (place.z > 1 || Math.abs(place.x) > 1.02 || Math.abs(place.y) > 1.02) return;
      spots.push({ key, name, x: ((place.x + 1) / 2) * width, y: ((1 - place.y) / 2) * height, far: far ?? place.z });
    };
    for (const model of settings.names ? models : []) {
      if (!model.canonical) continue;
      const top = model.canonical.position.clone();
      top.z += model.height + 0.05;
      add(model.name, model.name, top, model.name === chosen ? -2 : undefined);
    }
    frames.forEach(({ name, place }, i) => add(`${i}|${name}`, name, place.clone()));
    this.place(spots, chosen);
  }

  // The nearest first; a name that would lie on another one is left out, but for the chosen.
  private place(spots: Seen[], chosen: string | undefined): void {
    spots.sort((a, b) => a.far - b.far);
    const taken: { x: number; y: number; half: number }[] = [];
    const seen = new Set<string>();
    for (const { key, name, x, y } of spots) {
      const half = name.length * 3.2 + 5;
      if (taken.length >= 150 || taken.some((t) => Math.abs(t.y - y) < 17 && Math.abs(t.x - x) < t.half + half)) continue;
      taken.push({ x, y, half });
      seen.add(key);
      let label = this.names.get(key);
      if (!label) {
        label = h('span', { class: key === name ? undefined : 'frame' }, name);
        this.element.append(label);
        this.names.set(key, label);
      }
      label.classList.toggle('chosen', key === chosen);
      label.style.transform = `translate(${x}px,${y}px) translate(-50%,-100%)`;
    }
    for (const [key, label] of this.names) {
      if (seen.has(key)) continue;
      label.remove();
      this.names.delete(key);
    }
  }
}
