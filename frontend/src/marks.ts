// What lies on the floor or hangs in the air around people: soft shadows, rings and balls of doubt.

import { type Color, Object3D } from "three";
import type { Description, Numbers } from "./data";
import { Discs } from "./discs";
import type { State } from "./state";
import type { Theme } from "./theme";
import { between, type Track } from "./track";

export class Marks extends Object3D {
  private readonly shadows: Discs;
  private readonly rings: Discs;
  private readonly balls: Discs;

  constructor(private readonly about: Description, private readonly radii: Numbers[]) {
    super();
    const people = about.people.length, joints = about.skeleton.names.length;
    this.shadows = new Discs(2 * people * (1 + about.skeleton.feet.length), "shadow"); // of the truth too
    this.rings = new Discs(people * about.levels.length, "ring");
    this.balls = new Discs(people * about.levels.length * joints, "ball");
    this.add(this.shadows, this.rings, this.balls);
  }

  begin(): void {
    for (const discs of [this.shadows, this.rings, this.balls]) discs.begin();
  }

  end(): void {
    for (const discs of [this.shadows, this.rings, this.balls]) discs.end();
  }

  shadow(track: Track, person: number, look: Theme, strength: number): void {
    const { skeleton } = this.about;
    const hips = track.middle(person, skeleton.hips) ?? track.middle(person, track.seen(person));
    if (hips) this.shadows.mark(hips[0], hips[1], 0.002, 0.42, look.shadow, 0.3 * strength);
    for (const foot of skeleton.feet) {
      const spot = track.middle(person, [foot]);
      if (!spot) continue;
      const near = Math.max(1 - Math.max(spot[2] - 0.08, 0) / 0.5, 0);
      this.shadows.mark(spot[0], spot[1], 0.003, 0.2, look.shadow, 0.3 * near * strength);
    }
  }

  /** How far a person may be from where the forecast has them, at a frame after now. */
  doubt(track: Track, person: number, frame: number, kind: State["doubt"], color: Color): void {
    if (kind === "off") return;
    const { skeleton } = this.about;
    const { low, high, share } = between(frame, this.radii[0]?.shape[0] ?? 1);
    this.radii.forEach(({ values }, level) => {
      const radius = (joint: number) => values[low * track.joints + joint] * (1 - share) + values[high * track.joints + joint] * share;
      const strength = level === 0 ? 0.85 : 0.45;
      if (kind === "floor") {
        const spot = track.middle(person, skeleton.hips);
        const wide = skeleton.hips.reduce((sum, joint) => sum + radius(joint) / skeleton.hips.length, 0);
        if (spot) this.rings.mark(spot[0], spot[1], 0.01 + 0.001 * level, wide, color, strength);
        return;
      }
      for (const joint of skeleton.ends) {
        const spot = track.middle(person, [joint]);
        if (spot) this.balls.mark(...spot, radius(joint), color, strength * 0.6);
      }
    });
  }
}
