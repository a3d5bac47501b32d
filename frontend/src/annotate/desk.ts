// What the server of the page knows: motions, and their moments, which it keeps.

export type Source = "auto" | "accepted" | "manual" | "rejected";
export interface Moment { frame: number; person: number; source: Source; note: string }
export interface Entry { name: string; moments: number; open: number; seen: boolean } // `open`: found by the rule and not looked at
export interface Motion {
  name: string;
  fps: number;
  people: string[];
  bones: [number, number][];
  hips: number[];
  shape: [number, number, number, number]; // frames, people, joints, 3
  positions: string; // float32 of that shape, base64
  observed: string; // a byte of each joint, base64
  extents: number[][]; // of each person over frames, metres
  moments: Moment[];
}

const bytes = (text: string): ArrayBuffer => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

export const floats = (text: string): Float32Array => new Float32Array(bytes(text));
export const masks = (text: string): Float32Array => Float32Array.from(new Uint8Array(bytes(text)));

/** The address of the page ends with its secret, so paths that are relative to it carry it. */
async function ask(path: string, options: RequestInit = {}): Promise<Response> {
  const answer = await fetch(path, options);
  if (!answer.ok) throw new Error((await answer.text()) || `the server answered ${answer.status}`);
  return answer;
}

export const motions = async (): Promise<Entry[]> => (await ask("motions")).json();
export const motion = async (number: number): Promise<Motion> => (await ask(`motions/${number}`)).json();
export const keep = async (number: number, moments: Moment[]): Promise<void> => {
  await ask(`motions/${number}`, { method: "PUT", body: JSON.stringify(moments), headers: { "Content-Type": "application/json" } });
};
