// Who is there when: a lane a person on the time axis.

import type { Page } from "./data";
import { personColor } from "./theme";

/** From when to when a person is there, as frames counted from now. */
export type Stay = [from: number, to: number];

/** The stays of each person in history and forecast. */
export function staysOf({ about, arrays }: Page): Stay[][] {
  const { shape: [frames, people, joints], values } = arrays.get("main/observed")!;
  return Array.from({ length: people }, (_, person) => {
    const stays: Stay[] = [];
    for (let frame = 0; frame < frames; frame++) {
      const start = (frame * people + person) * joints;
      if (!values.subarray(start, start + joints).some((seen) => seen > 0)) continue;
      const time = frame + 1 - about.now, last = stays.at(-1);
      if (last && last[1] === time - 1) last[1] = time;
      else stays.push([time, time]);
    }
    return stays;
  });
}

/**
 * The lanes as a CSS background, one below the other: grey up to now, then in each person's colour. Where people come
 * and go, the grey has a `tint` of it, so that one finds out whose lane it is.
 */
export function lanes(stays: Stay[][], first: number, last: number, tint: boolean): string {
  const place = (time: number) => `${((100 * (Math.min(Math.max(time, first), last) - first)) / (last - first)).toFixed(2)}%`;
  return stays.map((own, person) => {
    const color = personColor(person).getStyle();
    const past = tint ? `color-mix(in srgb, ${color} 30%, var(--seen))` : "var(--seen)";
    const stops = own.flatMap(([from, to]) => {
      // a frame stands for the time around it, so that a stay of one frame is seen
      const [start, now, end] = [from - 0.5, Math.min(Math.max(0, from - 0.5), to + 0.5), to + 0.5].map(place);
      return [`transparent ${start}`, `${past} ${start} ${now}`, `${color} ${now} ${end}`, `transparent ${end}`];
    });
    const top = stays.length > 1 ? `${(100 * person) / (stays.length - 1)}%` : "0";
    return `linear-gradient(to right, ${stops.join(", ") || "transparent, transparent"}) 0 ${top} / 100% ${100 / stays.length}% no-repeat`;
  }).join(", ");
}
