// What the reader has chosen; kept in the address so that a view can be passed on.

export const CAMERAS = ["follow", "top", "front", "free"] as const;
export const LOOKS = ["bodies", "bones"] as const;
export const DOUBTS = ["off", "floor", "joints"] as const;
export const LAYERS = ["seen", "forecast", "truth", "paths", "stood", "things", "names", "goals", "heat"] as const;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4] as const;

export type Layer = (typeof LAYERS)[number];

export interface State {
  time: number;
  playing: boolean;
  speed: number;
  loop: boolean;
  camera: (typeof CAMERAS)[number];
  look: (typeof LOOKS)[number];
  doubt: (typeof DOUBTS)[number];
  layers: Set<Layer>;
  future: string; // "all" of them at once, or the number of one, from 1 on
}

/** What can be chosen among so many futures. */
export function futuresOf(count: number): string[] {
  return [...Array.from({ length: count }, (_, index) => `${index + 1}`), ...(count > 1 ? ["all"] : [])];
}

function one<T>(choices: readonly T[], wanted: unknown, usual: T): T {
  return choices.includes(wanted as T) ? (wanted as T) : usual;
}

export function readState(first: number, last: number, count: number): State {
  const hash = new URLSearchParams(location.hash.slice(1));
  const time = Number.parseFloat(hash.get("t") ?? "");
  const still = Number.isFinite(time) || matchMedia("(prefers-reduced-motion: reduce)").matches;
  const layers = hash.get("layers");
  return {
    time: Number.isFinite(time) ? Math.min(Math.max(time, first), last) : still ? 0 : Math.max(first, -1.5),
    playing: !still,
    speed: one(SPEEDS, Number(hash.get("speed")), 1),
    loop: hash.get("loop") !== "0",
    camera: one(CAMERAS, hash.get("camera"), "follow"),
    look: one(LOOKS, hash.get("look"), "bodies"),
    doubt: one(DOUBTS, hash.get("doubt"), "floor"),
    layers: new Set(LAYERS.filter((layer) => layers?.split(",").includes(layer) ?? layer !== "stood")),
    future: one(futuresOf(count), hash.get("future"), count > 1 ? "all" : "1"),
  };
}

export function writeState(state: State): void {
  const hash = new URLSearchParams({
    t: state.time.toFixed(2), camera: state.camera, look: state.look, doubt: state.doubt,
    layers: [...state.layers].join(","), speed: `${state.speed}`, loop: state.loop ? "1" : "0", future: state.future,
  });
  try {
    history.replaceState(null, "", `#${hash}`);
  } catch {
    // a page inside a frame without an address of its own has nowhere to keep it
  }
}
