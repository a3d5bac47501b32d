// Joints of people over time, read between frames.

import type { Numbers } from "./data";

export class Track {
  readonly frames: number;
  readonly people: number;
  readonly joints: number;
  readonly current: Float32Array; // (people, joints, 3) at the time last asked for
  readonly visible: Uint8Array; // (people, joints)

  /** `first` is the frame, counted from now, at which the numbers start. */
  constructor(readonly positions: Numbers, readonly observed: Numbers, readonly first: number) {
    [this.frames, this.people, this.joints] = positions.shape;
    this.current = new Float32Array(this.people * this.joints * 3);
    this.visible = new Uint8Array(this.people * this.joints);
  }

  has(frame: number): boolean {
    return this.frames > 0 && frame >= this.first - 1e-6 && frame <= this.first + this.frames - 1 + 1e-6;
  }

  /** Fills `current` and `visible`; outside of the track nobody is visible. */
  seek(frame: number): void {
    if (!this.has(frame)) { this.visible.fill(0); return; }
    const { low, high, share } = between(frame - this.first, this.frames);
    const size = this.current.length;
    const { values } = this.positions;
    for (let i = 0; i < size; i++) {
      this.current[i] = values[low * size + i] * (1 - share) + values[high * size + i] * share;
    }
    const count = this.visible.length;
    for (let i = 0; i < count; i++) {
      const a = this.observed.values[low * count + i], b = this.observed.values[high * count + i];
      this.visible[i] = a > 0 && (share === 0 || b > 0) ? 1 : 0;
    }
  }

  sees(person: number, joint: number): boolean {
    return this.visible[person * this.joints + joint] > 0;
  }

  seesAll(person: number): boolean {
    for (let joint = 0; joint < this.joints; joint++) if (!this.sees(person, joint)) return false;
    return true;
  }

  /** The joints of a person that are seen. */
  seen(person: number): number[] {
    return Array.from({ length: this.joints }, (_, joint) => joint).filter((joint) => this.sees(person, joint));
  }

  /** Where the middle of these joints is; null when one of them is not seen, or when there are none. */
  middle(person: number, joints: number[]): [number, number, number] | null {
    if (joints.length === 0) return null;
    const sum: [number, number, number] = [0, 0, 0];
    for (const joint of joints) {
      if (!this.sees(person, joint)) return null;
      for (let axis = 0; axis < 3; axis++) {
        sum[axis] += this.current[(person * this.joints + joint) * 3 + axis] / joints.length;
      }
    }
    return sum;
  }
}

/** The two frames around a fractional one, and how far it is on the way. */
export function between(frame: number, frames: number): { low: number; high: number; share: number } {
  const place = Math.min(Math.max(frame, 0), frames - 1);
  const low = Math.floor(place + 1e-6);
  const high = Math.min(low + 1, frames - 1);
  const share = Math.max(place - low, 0);
  return { low, high, share: share < 1e-4 ? 0 : share };
}
