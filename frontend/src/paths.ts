// The way of each person over the floor, as a ribbon.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial } from "three";
import type { Track } from "./track";

const WIDTH = 0.01;
const SMOOTH = 4; // frames before and after that a point of a path is averaged over: steps sway

type Spot = [number, number, number];

/** Ribbons of all people from frame `from` to frame `to`; dashed ones leave out every other piece of 8 cm. */
export function ribbon(
  track: Track, hips: number[], from: number, to: number, height: number, dashed: boolean, color: (person: number) => Color,
): Mesh<BufferGeometry, MeshBasicMaterial> {
  const corners: number[] = [], tints: number[] = [];
  for (let person = 0; person < track.people; person++) {
    const tint = color(person);
    let last: Spot | null = null;
    let walked = 0;
    for (const here of smooth(spots(track, person, hips, from, to))) {
      if (last && here) {
        const dx = here[0] - last[0], dy = here[1] - last[1];
        const length = Math.hypot(dx, dy);
        if (length < 0.02) continue; // a person who stands still needs no ribbon
        walked += length;
        if (!dashed || Math.floor(walked / 0.08) % 2 === 0) {
          const sx = (-dy / Math.max(length, 1e-6)) * WIDTH, sy = (dx / Math.max(length, 1e-6)) * WIDTH;
          const quad = [[last, 1], [last, -1], [here, 1], [here, 1], [last, -1], [here, -1]] as const;
          for (const [spot, side] of quad) {
            corners.push(spot[0] + side * sx, spot[1] + side * sy, height);
            tints.push(tint.r, tint.g, tint.b);
          }
        }
      }
      last = here;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(tints), 3));
  const material = new MeshBasicMaterial({
    vertexColors: true, transparent: true, opacity: 0.75, depthWrite: false, side: DoubleSide,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = 2;
  return mesh;
}

function spots(track: Track, person: number, hips: number[], from: number, to: number): (Spot | null)[] {
  return Array.from({ length: to - from + 1 }, (_, index) => {
    track.seek(from + index);
    return track.middle(person, hips);
  });
}

function smooth(path: (Spot | null)[]): (Spot | null)[] {
  return path.map((spot, index) => {
    if (!spot) return null;
    const width = Math.min(SMOOTH, index, path.length - 1 - index); // both ends stay where they are
    const near = path.slice(index - width, index + width + 1).filter((other) => other !== null);
    return [0, 1, 2].map((axis) => near.reduce((sum, other) => sum + other[axis], 0) / near.length) as Spot;
  });
}
