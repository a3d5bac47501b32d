// What the page is about: one JSON block, and one block of packed numbers that it describes.

export interface Person { id: string; guessed: boolean }
export interface Thing { name: string; category: string; shape: "box" | "cylinder" | "points" | "mesh"; size: [number, number, number] }
export interface Curve { name: string; kind: "model" | "baseline" | "radius"; times: number[]; errors: number[] }
export interface Description {
  schema: string;
  title: string;
  fps: number;
  now: number; // number of history frames; the last of them is time 0
  frames: number; // history and forecast together
  weights: number[]; // of the futures; the most probable one comes first
  truth: number; // frames of the truth track, the last history frame included; 0: none
  skeleton: { label: string; names: string[]; bones: [number, number][]; hips: number[]; feet: number[]; ends: number[] };
  people: Person[];
  objects: Thing[];
  goals: boolean; // whether each future ends in a goal of its own
  levels: string[];
  curves: Curve[];
  curvesTitle: string;
  warnings: string[];
  card: { name: string; system: string; parameters: number; data: string; licence: string };
  bones: number; // of the body; 0: the skeleton cannot carry one
  arrays: { name: string; shape: number[]; scale: number }[];
}

/** Numbers of one array, scaled, with the time axis first. */
export interface Numbers { shape: number[]; values: Float32Array }
export interface Page { about: Description; arrays: Map<string, Numbers> }

export async function readPage(): Promise<Page> {
  const about = JSON.parse(document.getElementById("about")!.textContent!) as Description;
  if (about.schema !== "motioncast.page/2") throw new Error(`this page cannot read ${about.schema}`);
  const packed = Uint8Array.from(atob(document.getElementById("numbers")!.textContent!.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  return { about, arrays: unpack(about, bytes) };
}

/** The inverse of `pack` in packing.py: zigzag steps of steps along the first axis, low bytes before high bytes. */
function unpack(about: Description, bytes: Uint8Array): Map<string, Numbers> {
  const half = bytes.length / 2;
  const arrays = new Map<string, Numbers>();
  let start = 0;
  for (const { name, shape, scale } of about.arrays) {
    const size = shape.reduce((product, side) => product * side, 1);
    const row = size / Math.max(shape[0], 1);
    const whole = new Int16Array(size);
    for (let index = 0; index < size; index++) {
      const zigzag = bytes[start + index] | (bytes[half + start + index] << 8);
      const step = (zigzag >>> 1) ^ -(zigzag & 1);
      whole[index] = step + (index >= row ? 2 * whole[index - row] : 0) - (index >= 2 * row ? whole[index - 2 * row] : 0);
    }
    arrays.set(name, { shape, values: Float32Array.from(whole, (value) => value * scale) });
    start += size;
  }
  return arrays;
}
