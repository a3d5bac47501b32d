// Names of things, written over the picture; of two that would lie on one another the nearer one stays.

import { type PerspectiveCamera, Vector3 } from "three";

interface Box { left: number; top: number; right: number; bottom: number }

const HIGH = 16, GAP = 4;

const meet = (one: Box, other: Box) =>
  one.left < other.right && one.right > other.left && one.top < other.bottom && one.bottom > other.top;

export class Labels {
  private readonly texts: { element: HTMLElement; width: number }[];
  private readonly spot = new Vector3();

  /** `covers` are other texts over the picture, which names must not touch. */
  constructor(root: HTMLElement, names: string[], private readonly covers: Element[]) {
    this.texts = names.map((name) => {
      const element = document.createElement("span");
      element.textContent = name;
      root.append(element);
      return { element, width: element.offsetWidth };
    });
  }

  /** Writes each name over its place in the world; those without a place are not written. */
  show(places: (Vector3 | null)[], camera: PerspectiveCamera, width: number, height: number): void {
    for (const { element } of this.texts) element.hidden = true;
    const taken: Box[] = this.covers.map((cover) => cover.getBoundingClientRect());
    const order = places.flatMap((place, index) =>
      place ? [{ place, text: this.texts[index], far: place.distanceTo(camera.position) }] : []);
    for (const { place, text } of order.sort((one, other) => one.far - other.far)) {
      this.spot.copy(place).project(camera);
      const left = ((this.spot.x + 1) * width - text.width) / 2, top = ((1 - this.spot.y) * height) / 2 - HIGH - GAP;
      const box = { left: left - GAP, top, right: left + text.width + GAP, bottom: top + HIGH };
      const within = this.spot.z < 1 && box.left > 0 && box.right < width && top > 0 && box.bottom < height;
      if (!within || taken.some((other) => meet(box, other))) continue;
      taken.push(box);
      text.element.hidden = false;
      text.element.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    }
  }
}
