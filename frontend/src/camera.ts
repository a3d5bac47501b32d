// Four ways to look: walking along with the people, from above, from in front, or wherever the reader likes.

import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Around } from "./extent";
import type { State } from "./state";

export class Eye {
  readonly camera = new PerspectiveCamera(32, 1, 0.05, 200);
  readonly controls: OrbitControls;
  private readonly step = new Vector3();
  private mode: State["camera"] | null = null;
  private free = 1; // the share of the height that nothing covers

  constructor(canvas: HTMLCanvasElement, private readonly around: Around) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 60;
  }

  /** Goes to where a way of looking starts. */
  choose(mode: State["camera"], middle: Vector3): void {
    if (mode === this.mode) return;
    const start = this.mode === null;
    this.mode = mode;
    if (mode === "free" && !start) return;
    const { apart, room, facing } = this.around;
    const high = mode === "top" ? Math.max(apart, room, 0.8) + 0.5 : Math.max(1.1 + 0.4 * apart, room && 0.9 + 0.55 * room);
    const wide = Math.max(apart + 0.55, 0.75 * room + 0.55, 1.1);
    const far = Math.max(high / this.free, wide / this.camera.aspect) / Math.tan((this.camera.fov * Math.PI) / 360);
    const angle = facing + (mode === "front" ? 0 : 0.65);
    const aside = room ? 0.5 : 0.28; // furniture is looked at from higher up
    const lift = { follow: aside, free: aside, front: room ? 0.35 : 0.12, top: Math.PI / 2 - 0.001 }[mode];
    const flat = Math.cos(lift) * far;
    this.controls.target.copy(middle);
    this.camera.position.set(
      middle.x + Math.cos(angle) * flat, middle.y + Math.sin(angle) * flat, middle.z + Math.sin(lift) * far,
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
