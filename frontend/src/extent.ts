// How far people and things stand apart and where people face, to choose floor and camera.

import { Vector3 } from "three";
import type { Page } from "./data";
import { kindOf } from "./kinds";
import type { Track } from "./track";

const NEAR = 3; // metres around the people that are worth showing for what else is there

export interface Around {
  facing: number; // where to look from, as an angle in the floor
  apart: number; // how far people get from their middle
  room: number; // how far furniture is from there, where there is some
}
export interface Extent extends Around { middle: [number, number]; reach: number }

/** The middle of all people who are there, at the height of a waist; `centre` stays where nobody is. */
export function middleOf(track: Track, hips: number[], centre: Vector3): Vector3 {
  const sum = new Vector3();
  let count = 0;
  for (let person = 0; person < track.people; person++) {
    const spot = track.middle(person, hips);
    if (spot) { sum.add(new Vector3(...spot)); count++; }
  }
  if (count) centre.set(sum.x / count, sum.y / count, Math.max(sum.z / count - 0.06, 0.4));
  return centre;
}

/** `futures`: the most probable one, which the history belongs to, comes first. */
export function extent({ about, arrays }: Page, futures: Track[], truth: Track | null): Extent {
  const { hips } = about.skeleton;
  const [main, ...others] = futures;
  const centre = new Vector3();
  let [west, east, south, north] = [Infinity, -Infinity, Infinity, -Infinity];
  let apart = 0, fx = 0, fy = 0;
  const away = (spot: [number, number, number] | null, most: number) => {
    if (spot) apart = Math.max(apart, Math.min(Math.hypot(spot[0] - centre.x, spot[1] - centre.y), most));
  };
  for (let frame = 1 - about.now; frame <= about.frames - about.now; frame += 5) {
    for (const track of [...futures, ...(truth ? [truth] : [])]) track.seek(frame);
    middleOf(main, hips, centre);
    about.people.forEach((_, person) => {
      if (truth) away(truth.middle(person, hips), Infinity);
      for (const other of others) away(other.middle(person, hips), NEAR);
      const spot = main.middle(person, hips);
      away(spot, Infinity);
      if (!spot) return;
      [west, east] = [Math.min(west, spot[0]), Math.max(east, spot[0])];
      [south, north] = [Math.min(south, spot[1]), Math.max(north, spot[1])];
      if (hips.length !== 2) return;
      const [left, right] = hips.map((hip) => main.middle(person, [hip])!);
      fx += left[1] - right[1];
      fy += right[0] - left[0];
    });
  }
  // a couple that faces one another has no common front: look across it
  let facing = Math.hypot(fx, fy) > 0.05 ? Math.atan2(fy, fx) : -Math.PI / 2;
  const middle: [number, number] = Number.isFinite(west) ? [(west + east) / 2, (south + north) / 2] : [0, 0];
  const reach = Number.isFinite(west) ? Math.max(east - west, north - south) / 2 + 8 : 10;
  let room = 0;
  let [dx, dy] = [Math.cos(facing), Math.sin(facing)]; // one looks from the people's side at the furniture behind them
  about.objects.forEach(({ category }, index) => {
    const [x, y] = arrays.get(`object/${index}/position`)!.values;
    const far = Math.hypot(x - middle[0], y - middle[1]);
    room = Math.max(room, Math.min(far, NEAR));
    if (kindOf(category).glass || far < 0.1) return;
    dx -= (x - middle[0]) / far;
    dy -= (y - middle[1]) / far;
  });
  if (room) facing = Math.atan2(dy, dx) - 0.5;
  return { middle, reach, apart, room, facing };
}
