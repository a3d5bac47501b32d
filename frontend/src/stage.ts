// The three-dimensional part: people, their futures, ghosts, things, floor, doubt.

import { Color, Object3D, Scene, Vector3, WebGLRenderer } from "three";
import { BodyMesh, bodyGeometry, Poses } from "./body";
import { Eye } from "./camera";
import type { Page } from "./data";
import { extent, middleOf } from "./extent";
import { Floor } from "./floor";
import { Furniture, type Piece } from "./furniture";
import { Goals } from "./goals";
import { Labels } from "./labels";
import { Marks } from "./marks";
import { ribbon } from "./paths";
import { Lines, Sticks } from "./skeleton";
import type { State } from "./state";
import { personColor, theme, type Theme } from "./theme";
import { Track } from "./track";

const THICK = 0.02, THIN = 0.007;

export class Stage {
  readonly eye: Eye;
  private readonly renderer: WebGLRenderer;
  private readonly world = new Scene();
  private readonly futures: Track[]; // the most probable one comes first and holds the history too
  private readonly stood: Track; // the last seen frame, shown beside the forecast on request
  private readonly truth: Track | null;
  private readonly colors: Color[];
  private readonly poses: Poses[] = []; // of the futures
  private readonly truthPoses: Poses | null = null;
  private readonly bodies: BodyMesh[] = [];
  private readonly ghosts: BodyMesh[] = [];
  private readonly sticks: Sticks;
  private readonly otherSticks: Sticks[]; // of each future that is not the one in the foreground
  private readonly truthSticks: Sticks;
  private readonly lines: Lines;
  private readonly marks: Marks;
  private readonly floor: Floor;
  private readonly furniture: Furniture;
  private readonly labels: Labels;
  private readonly goals: Goals;
  private readonly chances: Labels; // of the goals
  private readonly ways = new Object3D();
  private readonly centre = new Vector3();
  private faint: Color[] = []; // of the people in other futures
  private look: Theme = theme();
  sharpness = 1;

  constructor(canvas: HTMLCanvasElement, private readonly page: Page) {
    const { about, arrays } = page;
    const people = about.people.length, joints = about.skeleton.names.length;
    const array = (name: string) => arrays.get(name)!;
    const track = (name: string, first: number) => new Track(array(`${name}/positions`), array(`${name}/observed`), first);
    const past = 1 - about.now;
    const others = about.weights.slice(1).map((_, index) => `sample/${index}`);
    this.futures = [track("main", past), ...others.map((name) => track(name, 0))];
    this.stood = track("main", past);
    this.stood.seek(0);
    this.truth = about.truth ? track("truth", 0) : null;
    this.colors = about.people.map((_, person) => personColor(person));

    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true, powerPreference: "low-power" });
    const { middle, reach, ...around } = extent(page, this.futures, this.truth);
    this.eye = new Eye(canvas, around);
    this.floor = new Floor(middle, reach);
    this.furniture = new Furniture(page);
    const texts = ["top", "now", "options", "bar"].map((id) => document.getElementById(id)!);
    this.labels = new Labels(document.getElementById("names")!, about.objects.map((thing) => thing.name), texts);
    this.goals = new Goals(page, this.futures, this.stood);
    this.chances = new Labels(document.getElementById("names")!, this.goals.names, texts);
    const sticks = (thick: number, beside: boolean) => new Sticks(people, joints, about.skeleton.bones, thick, beside);
    this.sticks = sticks(THICK, false);
    this.otherSticks = this.futures.map(() => sticks(THIN, true));
    this.truthSticks = sticks(THIN, false);
    this.lines = new Lines(people * about.skeleton.bones.length, 0.5);
    this.marks = new Marks(about, about.levels.map((level) => array(`radius/${level}`)));
    this.world.add(
      this.floor, this.marks, this.ways, this.furniture, this.sticks, ...this.otherSticks, this.truthSticks, this.lines,
      this.goals,
    );
    if (about.bones) {
      const geometry = bodyGeometry(page);
      const poses = (name: string, first: number) => new Poses(array(`${name}/rotations`), array(`${name}/heads`), page, first);
      this.poses = [poses("main", past), ...others.map((name) => poses(name, 0))];
      if (this.truth) this.truthPoses = poses("truth", 0);
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
    this.furniture.paint(this.look);
    this.faint = this.colors.map((color) => color.clone().lerp(this.look.sky, 0.2));
    for (const way of this.ways.children) (way as ReturnType<typeof ribbon>).geometry.dispose();
    this.ways.clear();
    const { about } = this.page;
    const hips = about.skeleton.hips;
    const end = about.frames - about.now;
    this.ways.add(ribbon(this.futures[0], hips, 1 - about.now, 0, 0.004, false, () => this.look.seen));
    for (const future of this.futures) this.ways.add(ribbon(future, hips, 0, end, 0.006, false, (person) => this.colors[person]));
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
    const front = ahead && state.future !== "all" ? Number(state.future) - 1 : 0;
    const main = this.futures[front];
    for (const future of this.futures) future.seek(frame);
    this.truth?.seek(frame);
    middleOf(main, about.skeleton.hips, this.centre);
    this.eye.choose(state.camera, this.centre);
    this.eye.follow(this.centre, sudden);

    const shown = ahead ? state.layers.has("forecast") : state.layers.has("seen");
    const truly = ahead && this.truth !== null && state.layers.has("truth") && this.truth.has(frame);
    const bodily = (track: Track, person: number) => state.look === "bodies" && this.poses.length > 0 && track.seesAll(person);
    about.people.forEach((_, person) => {
      const body = this.bodies[person], ghost = this.ghosts[person];
      if (!body) return;
      body.visible = shown && bodily(main, person);
      ghost.visible = truly && bodily(this.truth!, person);
      if (body.visible) { this.poses[front].read(frame, person, body.bones); body.paint(this.tint(person, ahead)); }
      if (ghost.visible) { this.truthPoses!.read(frame, person, ghost.bones); ghost.paint(this.look.ink); }
    });
    this.sticks.show(main, (person) => (shown && !bodily(main, person) ? this.tint(person, ahead) : null));
    const others = ahead && shown && state.future === "all";
    this.otherSticks.forEach((sticks, index) => {
      sticks.visible = others && index !== front;
      if (sticks.visible) sticks.show(this.futures[index], (person) => this.faint[person]);
    });
    this.truthSticks.visible = this.truth !== null;
    if (this.truth) {
      this.truthSticks.show(this.truth, (person) => (truly && !bodily(this.truth!, person) ? this.look.ink : null));
    }
    this.lines.begin();
    if (ahead && state.layers.has("stood")) this.lines.draw(this.stood, about.skeleton.bones, () => this.look.seen);
    this.lines.end();
    this.marks.begin();
    about.people.forEach((_, person) => {
      if (shown) this.marks.shadow(main, person, this.look, 1);
      if (truly) this.marks.shadow(this.truth!, person, this.look, 0.4);
      if (ahead && shown && front === 0) this.marks.doubt(main, person, frame, state.doubt, this.colors[person]);
    });
    this.marks.end();
    this.showWays(state);
    this.goals.show(state.layers.has("goals"), state.layers.has("heat"), this.look, this.colors);
    this.showThings(state, frame, main);
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

  private showWays(state: State): void {
    const paths = state.layers.has("paths");
    const [seen, ...rest] = this.ways.children as ReturnType<typeof ribbon>[];
    seen.visible = paths && state.layers.has("seen");
    rest.forEach((way, index) => {
      if (index === this.futures.length) { way.visible = paths && state.layers.has("truth"); return; }
      const alone = state.future === `${index + 1}`;
      way.visible = paths && state.layers.has("forecast") && (alone || state.future === "all");
      way.material.opacity = alone || index === 0 ? 0.75 : 0.25;
    });
  }

  private showThings(state: State, frame: number, main: Track): void {
    const { about } = this.page;
    const { camera } = this.eye;
    this.furniture.visible = state.layers.has("things");
    this.furniture.show(frame + about.now - 1, ends(main, false), ends(main, true), camera.position);
    const named = this.furniture.visible && state.layers.has("names");
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
    camera.updateMatrixWorld();
    // a name on the glass in front of people would seem to be theirs
    const near = this.centre.distanceTo(camera.position);
    const place = (piece: Piece) => {
      const top = piece.top();
      return piece.seeThrough && top.distanceTo(camera.position) < near ? null : top;
    };
    this.labels.show(named ? this.furniture.pieces.map(place) : [], camera, width, height);
    this.chances.show(state.layers.has("goals") ? this.goals.places() : [], camera, width, height);
  }
}

/** The highest or lowest joint of everybody who is there. */
function ends(track: Track, lowest: boolean): Vector3[] {
  return Array.from({ length: track.people }, (_, person) => track.seen(person)).flatMap((joints, person) => {
    const spots = joints.map((joint) => new Vector3().fromArray(track.current, (person * track.joints + joint) * 3));
    return spots.sort((one, other) => (lowest ? one.z - other.z : other.z - one.z)).slice(0, 1);
  });
}
