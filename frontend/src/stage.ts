// The three-dimensional part: people, ghosts, floor, doubt.

import { Color, Object3D, Scene, Vector3, WebGLRenderer } from "three";
import { BodyMesh, bodyGeometry, Poses } from "./body";
import { Eye } from "./camera";
import type { Numbers, Page } from "./data";
import { Discs } from "./discs";
import { Floor } from "./floor";
import { ribbon } from "./paths";
import { Lines, Sticks } from "./skeleton";
import type { State } from "./state";
import { personColor, theme, type Theme } from "./theme";
import { between, Track } from "./track";

const THICK = 0.02, THIN = 0.007;

export class Stage {
  readonly eye: Eye;
  private readonly renderer: WebGLRenderer;
  private readonly world = new Scene();
  private readonly main: Track;
  private readonly stood: Track; // the last seen frame, shown beside the forecast on request
  private readonly truth: Track | null;
  private readonly samples: Track[];
  private readonly colors: Color[];
  private readonly radii: Numbers[];
  private readonly poses: Poses | null = null;
  private readonly truthPoses: Poses | null = null;
  private readonly bodies: BodyMesh[] = [];
  private readonly ghosts: BodyMesh[] = [];
  private readonly sticks: Sticks;
  private readonly truthSticks: Sticks;
  private readonly lines: Lines;
  private readonly shadows: Discs;
  private readonly rings: Discs;
  private readonly balls: Discs;
  private readonly floor: Floor;
  private readonly ways = new Object3D();
  private readonly centre = new Vector3();
  private look: Theme = theme();
  sharpness = 1;

  constructor(canvas: HTMLCanvasElement, private readonly page: Page) {
    const { about, arrays } = page;
    const people = about.people.length, joints = about.skeleton.names.length;
    const array = (name: string) => arrays.get(name)!;
    this.main = new Track(array("main/positions"), array("main/observed"), 1 - about.now);
    this.stood = new Track(array("main/positions"), array("main/observed"), 1 - about.now);
    this.stood.seek(0);
    this.truth = about.truth ? new Track(array("truth/positions"), array("truth/observed"), 0) : null;
    this.samples = Array.from({ length: about.samples - 1 }, (_, index) =>
      new Track(array(`sample/${index}`), array("sample/observed"), 0));
    this.radii = about.levels.map((level) => array(`radius/${level}`));
    this.colors = about.people.map((_, person) => personColor(person));

    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true, powerPreference: "low-power" });
    const { middle, reach, apart, facing } = this.extent();
    this.eye = new Eye(canvas, facing, apart);
    this.floor = new Floor(middle, reach);
    this.sticks = new Sticks(people, joints, about.skeleton.bones, THICK);
    this.truthSticks = new Sticks(people, joints, about.skeleton.bones, THIN);
    this.lines = new Lines((about.samples + 1) * people * about.skeleton.bones.length, 0.5);
    this.shadows = new Discs(2 * people * (1 + about.skeleton.feet.length), "shadow"); // of the truth too
    this.rings = new Discs(people * about.levels.length, "ring");
    this.balls = new Discs(people * about.levels.length * joints, "ball");
    this.world.add(
      this.floor, this.shadows, this.ways, this.rings, this.sticks, this.truthSticks, this.lines, this.balls,
    );
    if (about.bones) {
      const geometry = bodyGeometry(page);
      this.poses = new Poses(array("main/rotations"), array("main/heads"), page, 1 - about.now);
      if (this.truth) this.truthPoses = new Poses(array("truth/rotations"), array("truth/heads"), page, 0);
      for (let person = 0; person < people; person++) {
        this.bodies.push(new BodyMesh(geometry, about.bones, false));
        this.ghosts.push(new BodyMesh(geometry, about.bones, true));
      }
      this.world.add(...this.bodies, ...this.ghosts);
    }
    this.paint();
  }

  /** Takes the colours of the theme. */
  paint(): void {
    this.look = theme();
    this.world.background = this.look.sky;
    this.floor.paint(this.look);
    for (const way of this.ways.children) (way as ReturnType<typeof ribbon>).geometry.dispose();
    this.ways.clear();
    const { about } = this.page;
    const hips = about.skeleton.hips;
    const end = about.frames - about.now;
    this.ways.add(
      ribbon(this.main, hips, 1 - about.now, 0, 0.004, false, () => this.look.seen),
      ribbon(this.main, hips, 0, end, 0.006, false, (person) => this.colors[person]),
    );
    if (this.truth) this.ways.add(ribbon(this.truth, hips, 0, about.truth - 1, 0.008, true, () => this.look.ink));
  }

  /** Fits the picture into the window; `top` and `bottom` are heights in pixels that other things cover. */
  resize(top: number, bottom: number): void {
    const canvas = this.renderer.domElement;
    const { clientWidth: width, clientHeight: height } = canvas;
    this.sharpen(this.sharpness);
    this.eye.resize(width, height, top, bottom);
  }

  /** Draws with this share of the window's pixels along each side. */
  sharpen(sharpness: number): void {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
    this.sharpness = sharpness;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * sharpness);
    this.renderer.setSize(width, height, false);
  }

  draw(state: State, sudden: boolean): void {
    const { about } = this.page;
    const frame = state.time * about.fps;
    const ahead = frame > 1e-3;
    this.main.seek(frame);
    this.truth?.seek(frame);
    this.eye.choose(state.camera, this.middle());
    this.eye.follow(this.middle(), sudden);

    const shown = ahead ? state.layers.has("forecast") : state.layers.has("seen");
    const truly = ahead && this.truth !== null && state.layers.has("truth") && this.truth.has(frame);
    const color = (person: number) => (shown ? this.tint(person, ahead) : null);
    const bodily = (track: Track, person: number) => state.look === "bodies" && this.poses !== null && track.seesAll(person);
    about.people.forEach((_, person) => {
      const body = this.bodies[person], ghost = this.ghosts[person];
      if (!body) return;
      body.visible = shown && bodily(this.main, person);
      ghost.visible = truly && bodily(this.truth!, person);
      if (body.visible) { this.poses!.read(frame, person, body.bones); body.paint(this.tint(person, ahead)); }
      if (ghost.visible) { this.truthPoses!.read(frame, person, ghost.bones); ghost.paint(this.look.ink); }
    });
    this.sticks.show(this.main, (person) => (bodily(this.main, person) ? null : color(person)));
    this.truthSticks.visible = this.truth !== null;
    if (this.truth) {
      this.truthSticks.show(this.truth, (person) => (truly && !bodily(this.truth!, person) ? this.look.ink : null));
    }
    this.drawLines(state, frame, ahead);
    this.drawMarks(state, frame, ahead, shown, truly);
    const [seen, forecast, truth] = this.ways.children;
    seen.visible = state.layers.has("paths") && state.layers.has("seen");
    forecast.visible = state.layers.has("paths") && state.layers.has("forecast");
    if (truth) truth.visible = state.layers.has("paths") && state.layers.has("truth");
    this.renderer.render(this.world, this.eye.camera);
  }

  /** Number of colours on a coarse grid over the picture just drawn; a blank picture has one. */
  colorsDrawn(): number {
    const gl = this.renderer.getContext();
    const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    const pixels = new Uint8Array(width * height * 4);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const found = new Set<number>();
    for (let index = 0; index < width * height; index += 37) {
      found.add((pixels[index * 4] << 16) | (pixels[index * 4 + 1] << 8) | pixels[index * 4 + 2]);
    }
    return found.size;
  }

  private tint(person: number, ahead: boolean): Color {
    return ahead ? this.colors[person] : this.look.seen.clone().lerp(this.colors[person], 0.05);
  }

  private drawLines(state: State, frame: number, ahead: boolean): void {
    const { bones } = this.page.about.skeleton;
    this.lines.begin();
    if (ahead && state.layers.has("stood")) this.lines.draw(this.stood, bones, () => this.look.seen);
    if (ahead && state.layers.has("forecast")) {
      for (const sample of this.samples.slice(0, state.samples - 1)) {
        sample.seek(frame);
        this.lines.draw(sample, bones, (person) => this.colors[person]);
      }
    }
    this.lines.end();
  }

  private drawMarks(state: State, frame: number, ahead: boolean, shown: boolean, truly: boolean): void {
    const { skeleton, people } = this.page.about;
    this.shadows.begin();
    this.rings.begin();
    this.balls.begin();
    const shadow = (track: Track, person: number, strength: number) => {
      const hips = track.middle(person, skeleton.hips) ?? track.middle(person, track.seen(person));
      if (hips) this.shadows.mark(hips[0], hips[1], 0.002, 0.42, this.look.shadow, 0.3 * strength);
      for (const foot of skeleton.feet) {
        const spot = track.middle(person, [foot]);
        if (!spot) continue;
        const near = Math.max(1 - Math.max(spot[2] - 0.08, 0) / 0.5, 0);
        this.shadows.mark(spot[0], spot[1], 0.003, 0.2, this.look.shadow, 0.3 * near * strength);
      }
    };
    people.forEach((_, person) => {
      if (shown) shadow(this.main, person, 1);
      if (truly) shadow(this.truth!, person, 0.4);
      if (!ahead || !shown || state.doubt === "off") return;
      const { low, high, share } = between(frame, this.radii[0]?.shape[0] ?? 1);
      const joints = this.main.joints;
      this.radii.forEach(({ values }, level) => {
        const radius = (joint: number) => values[low * joints + joint] * (1 - share) + values[high * joints + joint] * share;
        const strength = level === 0 ? 0.85 : 0.45;
        if (state.doubt === "floor") {
          const spot = this.main.middle(person, skeleton.hips);
          const wide = skeleton.hips.reduce((sum, joint) => sum + radius(joint) / skeleton.hips.length, 0);
          if (spot) this.rings.mark(spot[0], spot[1], 0.01 + 0.001 * level, wide, this.colors[person], strength);
          return;
        }
        for (const joint of skeleton.ends) {
          const spot = this.main.middle(person, [joint]);
          if (spot) this.balls.mark(...spot, radius(joint), this.colors[person], strength * 0.6);
        }
      });
    });
    this.shadows.end();
    this.rings.end();
    this.balls.end();
  }

  /** The middle of all people who are there, at the height of a waist. */
  private middle(): Vector3 {
    const { people, skeleton } = this.page.about;
    const sum = new Vector3();
    let count = 0;
    people.forEach((_, person) => {
      const hips = this.main.middle(person, skeleton.hips);
      if (hips) { sum.add(new Vector3(...hips)); count++; }
    });
    if (count) this.centre.set(sum.x / count, sum.y / count, Math.max(sum.z / count - 0.06, 0.4));
    return this.centre;
  }

  /** How far people stand apart and where they face, to choose floor and camera. */
  private extent(): { middle: [number, number]; reach: number; apart: number; facing: number } {
    const { about } = this.page;
    const { hips } = about.skeleton;
    let [west, east, south, north] = [Infinity, -Infinity, Infinity, -Infinity];
    let apart = 0, fx = 0, fy = 0;
    for (let frame = 1 - about.now; frame <= about.frames - about.now; frame += 5) {
      this.main.seek(frame);
      this.truth?.seek(frame);
      const centre = this.middle();
      about.people.forEach((_, person) => {
        const really = this.truth?.middle(person, hips);
        if (really) apart = Math.max(apart, Math.hypot(really[0] - centre.x, really[1] - centre.y));
        const spot = this.main.middle(person, hips);
        if (!spot) return;
        [west, east] = [Math.min(west, spot[0]), Math.max(east, spot[0])];
        [south, north] = [Math.min(south, spot[1]), Math.max(north, spot[1])];
        apart = Math.max(apart, Math.hypot(spot[0] - centre.x, spot[1] - centre.y));
        if (hips.length !== 2) return;
        const [left, right] = hips.map((hip) => this.main.middle(person, [hip])!);
        fx += left[1] - right[1];
        fy += right[0] - left[0];
      });
    }
    // a couple that faces one another has no common front: look across it
    const facing = Math.hypot(fx, fy) > 0.05 ? Math.atan2(fy, fx) : -Math.PI / 2;
    if (!Number.isFinite(west)) return { middle: [0, 0], reach: 10, apart, facing };
    const reach = Math.max(east - west, north - south) / 2 + 8;
    return { middle: [(west + east) / 2, (south + north) / 2], reach, apart, facing };
  }
}
