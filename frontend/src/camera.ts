// Four ways to look: walking along with the people, from above, from in front, or wherever the reader likes.

import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { State } from "./state";

export class Eye {
  readonly camera = new PerspectiveCamera(32, 1, 0.05, 200);
  readonly controls: OrbitControls;
  private readonly step = new Vector3();
  private mode: State["camera"] | null = null;
  private free = 1; // the share of the height that nothing covers

  /** `facing`: where the people look, as an angle in the floor; `apart`: how far they get from their middle. */
  constructor(canvas: HTMLCanvasElement, private readonly facing: number, private readonly apart: number) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 60;
  }

  /** Goes to where a way of looking starts. */
  choose(mode: State["camera"], middle: Vector3): void {
    if (mode === this.mode) return;
    this.mode = mode;
    if (mode === "free") return;
    const high = mode === "top" ? Math.max(this.apart + 0.5, 1.3) : 1.1 + 0.4 * this.apart;
    const wide = Math.max(this.apart + 0.55, 1.1);
    const room = Math.max(high / this.free, wide / this.camera.aspect) / Math.tan((this.camera.fov * Math.PI) / 360);
    const angle = this.facing + (mode === "front" ? 0 : 0.65);
    const lift = { follow: 0.28, front: 0.12, top: Math.PI / 2 - 0.001 }[mode];
    const flat = Math.cos(lift) * room;
    this.controls.target.copy(middle);
    this.camera.position.set(
      middle.x + Math.cos(angle) * flat, middle.y + Math.sin(angle) * flat, middle.z + Math.sin(lift) * room,
    );
    this.controls.update();
  }

  /** Walks along with the people, unless the reader wants to stand still. */
  follow(middle: Vector3, sudden: boolean): void {
    if (this.mode === "free") return;
    this.step.copy(middle).sub(this.controls.target).multiplyScalar(sudden ? 1 : 0.12);
    this.controls.target.add(this.step);
    this.camera.position.add(this.step);
    this.controls.update();
  }

  resize(width: number, height: number, top: number, bottom: number): void {
    const before = this.camera.aspect;
    this.camera.aspect = width / height;
    this.free = Math.max(1 - (top + bottom) / height, 0.3);
    this.camera.setViewOffset(width, height, 0, (bottom - top) / 2, width, height);
    if (Math.abs(before - this.camera.aspect) > 0.3) this.mode = this.mode === "free" ? "free" : null;
  }
}
