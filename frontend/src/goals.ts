// Where futures end, drawn as lines the bolder the more probable, and where hands may come to be, as clouds.

import { BufferAttribute, BufferGeometry, Color, Object3D, Points, PointsMaterial, Vector3 } from "three";
import type { Page } from "./data";
import { Lines } from "./skeleton";
import type { Theme } from "./theme";
import { Track } from "./track";

const FAINT = 0.05; // a goal that is less probable has no number

const HANDS = [new Color(0xd9482b), new Color(0x2b6fd9)]; // right, left

export class Goals extends Object3D {
  readonly names: string[] = [];
  private readonly ends: Track[] = []; // of each future, stopped at its last frame
  private readonly lines: Lines;
  private readonly cloud: Points<BufferGeometry, PointsMaterial>;

  constructor(private readonly page: Page, futures: Track[], private readonly stood: Track) {
    super();
    const { about, arrays } = page;
    if (about.goals) {
      this.ends = futures.map((future) => new Track(future.positions, future.observed, future.first));
      for (const end of this.ends) end.seek(end.first + end.frames - 1);
      this.names = about.weights.map((weight) => `${Math.round(weight * 100)} %`);
    }
    this.lines = new Lines(this.ends.length * about.people.length * about.skeleton.bones.length, 0.9);
    const geometry = new BufferGeometry();
    const places = arrays.get("heat/positions"), heat = arrays.get("heat/weights"), hand = arrays.get("heat/hands");
    const tints = new Float32Array((heat?.values.length ?? 0) * 4);
    heat?.values.forEach((weight, point) => tints.set([...HANDS[hand!.values[point]].toArray(), 0.06 + 0.5 * weight], point * 4));
    geometry.setAttribute("position", new BufferAttribute(places?.values ?? new Float32Array(), 3));
    geometry.setAttribute("color", new BufferAttribute(tints, 4));
    const material = new PointsMaterial({ size: 0.1, vertexColors: true, transparent: true, depthWrite: false });
    material.onBeforeCompile = (shader) => { // soft balls instead of squares
      const soft = "#include <color_fragment>\ndiffuseColor.a *= smoothstep(0.5, 0.1, length(gl_PointCoord - 0.5));";
      shader.fragmentShader = shader.fragmentShader.replace("#include <color_fragment>", soft);
    };
    this.cloud = new Points(geometry, material);
    this.cloud.frustumCulled = false;
    this.cloud.renderOrder = 2;
    this.add(this.lines, this.cloud);
  }

  show(lines: boolean, heat: boolean, look: Theme, colors: Color[]): void {
    this.cloud.visible = heat;
    const { weights, skeleton } = this.page.about;
    const most = Math.max(...weights);
    this.lines.begin();
    if (lines) {
      this.ends.forEach((end, goal) => {
        const strength = 0.25 + 0.75 * (weights[goal] / most);
        this.lines.draw(end, skeleton.bones, (person) => look.sky.clone().lerp(colors[person], strength));
      });
    }
    this.lines.end();
  }

  /** Where each goal's probability is written: at the hand, foot or head of the first person that has farthest to go. */
  places(): (Vector3 | null)[] {
    const spot = (track: Track, joint: number) => new Vector3().fromArray(track.current, joint * 3);
    return this.ends.map((end, goal) => {
      if (this.page.about.weights[goal] < FAINT) return null;
      const seen = this.page.about.skeleton.ends.filter((joint) => end.sees(0, joint) && this.stood.sees(0, joint));
      const way = (joint: number) => spot(end, joint).distanceTo(spot(this.stood, joint));
      const farthest = seen.sort((one, other) => way(other) - way(one))[0];
      return farthest === undefined ? null : spot(end, farthest);
    });
  }
}
