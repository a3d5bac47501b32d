// The people of one motion in three dimensions, bare bones.

import { Scene, Vector3, WebGLRenderer } from "three";
import { Eye } from "../camera";
import { middleOf } from "../extent";
import { Floor } from "../floor";
import { Sticks } from "../skeleton";
import { personColor, theme } from "../theme";
import { Track } from "../track";
import { floats, masks, type Motion } from "./desk";

export class View {
  private readonly renderer: WebGLRenderer;
  private readonly world = new Scene();
  private readonly centre = new Vector3();
  private track: Track | null = null;
  private sticks: Sticks | null = null;
  private floor: Floor | null = null;
  private eye: Eye | null = null;
  private hips: number[] = [];

  constructor(private readonly canvas: HTMLCanvasElement, private readonly drag: () => void) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true, powerPreference: "low-power" });
  }

  open(motion: Motion): void {
    const [frames, people, joints] = motion.shape;
    this.track = new Track(
      { shape: motion.shape, values: floats(motion.positions) }, { shape: [frames, people, joints], values: masks(motion.observed) }, 0,
    );
    this.hips = motion.hips;
    this.world.clear();
    this.sticks = new Sticks(people, joints, motion.bones, 0.02, false);
    this.track.seek(0);
    middleOf(this.track, this.hips, this.centre);
    this.floor = new Floor([this.centre.x, this.centre.y], 30);
    this.world.add(this.floor, this.sticks);
    this.eye?.controls.dispose();
    this.eye = new Eye(this.canvas, { apart: people > 1 ? 0.8 : 0.3, room: 0, facing: this.facing() });
    this.eye.controls.addEventListener("change", this.drag);
    this.paint();
    this.resize();
    this.eye.choose("follow", this.centre);
  }

  paint(): void {
    const look = theme();
    this.world.background = look.sky;
    this.floor?.paint(look);
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.eye?.resize(width, height, 0, 0);
  }

  /** `marked`: whether the playhead is at a moment; who is edited is drawn in colour then. */
  draw(frame: number, person: number, marked: boolean): void {
    if (!this.track || !this.eye || !this.sticks) return;
    const look = theme();
    this.track.seek(frame);
    middleOf(this.track, this.hips, this.centre);
    this.eye.choose("follow", this.centre);
    this.eye.follow(this.centre, true);
    const color = (one: number) => (one !== person ? look.seen : marked ? personColor(person) : look.ink);
    this.sticks.show(this.track, color);
    this.renderer.render(this.world, this.eye.camera);
  }

  /** Where the first person faces at first, as an angle in the floor. */
  private facing(): number {
    const [left, right] = this.hips.map((hip) => this.track!.middle(0, [hip]));
    return left && right ? Math.atan2(right[0] - left[0], left[1] - right[1]) : 0;
  }
}
