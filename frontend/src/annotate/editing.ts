// The moments of one motion, and what one can do to them; every change can be undone.

import type { Moment } from "./desk";

const CLOSE_S = 0.5; // a moment is at the playhead when it is nearer than that

export class Editing {
  private readonly past: Moment[][] = [];

  constructor(public moments: Moment[], private readonly fps: number, private readonly changed: () => void) {}

  /** The moments of a person in order of time. */
  of(person: number): Moment[] {
    return this.moments.filter((moment) => moment.person === person).sort((a, b) => a.frame - b.frame);
  }

  /** The moment of a person that the playhead is at. */
  at(person: number, frame: number): Moment | null {
    const near = this.of(person).filter((moment) => Math.abs(moment.frame - frame) <= CLOSE_S * this.fps);
    return near.sort((a, b) => Math.abs(a.frame - frame) - Math.abs(b.frame - frame))[0] ?? null;
  }

  /** The next moment after the playhead, or the one before it. */
  beside(person: number, frame: number, forward: boolean): Moment | null {
    const all = this.of(person);
    return (forward ? all.find((moment) => moment.frame > frame) : all.reverse().find((moment) => moment.frame < frame)) ?? null;
  }

  accept(person: number, frame: number): void {
    this.replace(this.at(person, frame), (moment) => ({ ...moment, source: moment.source === "manual" ? "manual" : "accepted" }));
  }

  acceptAll(): void {
    if (!this.moments.some((moment) => moment.source === "auto")) return;
    this.set(this.moments.map((moment) => (moment.source === "auto" ? { ...moment, source: "accepted" } : moment)));
  }

  /** A rejected moment stays in the table: the rule must not bring it back. One that was set by hand goes. */
  reject(person: number, frame: number): void {
    const moment = this.at(person, frame);
    if (moment?.source === "manual") this.set(this.moments.filter((other) => other !== moment));
    else this.replace(moment, (found) => ({ ...found, source: "rejected" }));
  }

  move(person: number, frame: number): void {
    this.replace(this.at(person, frame), (moment) => ({ ...moment, frame, source: "manual" }));
  }

  insert(person: number, frame: number): void {
    const others = this.moments.filter((moment) => moment.person !== person || moment.frame !== frame);
    this.set([...others, { frame, person, source: "manual", note: "" }]);
  }

  undo(): void {
    const before = this.past.pop();
    if (!before) return;
    this.moments = before;
    this.changed();
  }

  private replace(moment: Moment | null, change: (moment: Moment) => Moment): void {
    if (moment) this.set(this.moments.map((other) => (other === moment ? change(moment) : other)));
  }

  private set(moments: Moment[]): void {
    this.past.push(this.moments);
    this.moments = moments;
    this.changed();
  }
}
