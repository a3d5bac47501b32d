// Things around the people: calm solids with edges. What must not hide anybody is glass.

import {
  Box3, BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, Object3D, Points, PointsMaterial, Quaternion, Ray, ShaderMaterial, Vector3,
} from "three";
import { LIGHT } from "./body";
import type { Numbers, Page, Thing } from "./data";
import { kindColor, kindOf } from "./kinds";
import type { Theme } from "./theme";
import { between } from "./track";

const VERTEX = `
varying vec3 place;
void main() {
  vec4 there = modelMatrix * vec4(position, 1.0);
  place = there.xyz;
  gl_Position = projectionMatrix * viewMatrix * there;
}`;

const FRAGMENT = `
uniform vec3 color;
uniform float opacity;
varying vec3 place;
${LIGHT}
void main() {
  vec3 n = normalize(cross(dFdx(place), dFdy(place)));
  gl_FragColor = vec4(lit(color, n, normalize(cameraPosition - place)), opacity);
  #include <colorspace_fragment>
}`;

const SOLID = 0.94, GLASS = 0.1;
const TALL = 1.2; // metres; what is lower may hide legs, as tables do

export class Piece extends Group {
  seeThrough = false;
  private readonly bounds = new Box3();
  private readonly surface: Mesh<BufferGeometry, ShaderMaterial> | null = null;
  private readonly lines: LineSegments<EdgesGeometry, LineBasicMaterial> | null = null;
  private readonly dots: Points<BufferGeometry, PointsMaterial> | null = null;
  private readonly to = new Quaternion();
  private readonly inverse = new Matrix4();
  private readonly ray = new Ray();
  private readonly hit = new Vector3();

  constructor(
    readonly about: Thing, geometry: BufferGeometry, private readonly positions: Numbers, private readonly rotations: Numbers,
  ) {
    super();
    geometry.computeBoundingBox();
    this.bounds.copy(geometry.boundingBox!);
    if (about.shape === "points") {
      this.dots = new Points(geometry, new PointsMaterial({ size: 0.045, transparent: true }));
      this.add(this.dots);
    } else {
      this.surface = new Mesh(geometry, new ShaderMaterial({
        vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true,
        uniforms: { color: { value: new Color() }, opacity: { value: SOLID } },
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      }));
      this.lines = new LineSegments(new EdgesGeometry(geometry, 30), new LineBasicMaterial({ transparent: true, depthWrite: false }));
      this.add(this.surface, this.lines);
    }
    for (const part of this.children) part.renderOrder = 3;
  }

  /** Where it stands in a frame, counted from its first; before and after, it stays. */
  place(frame: number): void {
    const at = (numbers: Numbers) => between(frame, numbers.shape[0]);
    const p = this.positions.values, q = this.rotations.values;
    const here = at(this.positions), turn = at(this.rotations);
    for (const axis of [0, 1, 2]) {
      this.position.setComponent(axis, p[here.low * 3 + axis] * (1 - here.share) + p[here.high * 3 + axis] * here.share);
    }
    const read = (into: Quaternion, row: number) => into.set(q[row * 4 + 1], q[row * 4 + 2], q[row * 4 + 3], q[row * 4]).normalize();
    read(this.quaternion, turn.low).slerp(read(this.to, turn.high), turn.share);
    this.updateMatrixWorld();
    this.inverse.copy(this.matrixWorld).invert();
  }

  paint(look: Theme): void {
    const color = kindColor(this.about.category, look.dark);
    const edge = color.clone().lerp(look.ink, 0.45);
    this.surface?.material.uniforms.color.value.copy(color);
    this.lines?.material.color.copy(edge);
    this.dots?.material.color.copy(edge);
  }

  glass(on: boolean): void {
    this.seeThrough = on;
    if (this.surface) {
      this.surface.material.uniforms.opacity.value = on ? GLASS : SOLID;
      this.surface.material.depthWrite = !on;
    }
    if (this.lines) this.lines.material.opacity = on ? 0.35 : 0.7;
    if (this.dots) this.dots.material.opacity = on ? 0.4 : 0.9;
  }

  /** Whether it stands between the eye and a spot. */
  hides(spot: Vector3, eye: Vector3): boolean {
    this.ray.origin.copy(eye).applyMatrix4(this.inverse);
    this.ray.direction.copy(spot).applyMatrix4(this.inverse).sub(this.ray.origin);
    const far = this.ray.direction.length();
    this.ray.direction.divideScalar(far);
    return this.ray.intersectBox(this.bounds, this.hit) !== null && this.hit.distanceTo(this.ray.origin) < far;
  }

  /** The middle of its top, where its name stands. */
  top(): Vector3 {
    const { min, max } = this.bounds;
    return new Vector3((min.x + max.x) / 2, (min.y + max.y) / 2, max.z).applyMatrix4(this.matrixWorld);
  }
}

export class Furniture extends Object3D {
  readonly pieces: Piece[];

  constructor(page: Page) {
    super();
    this.pieces = page.about.objects.map((about, index) => {
      const array = (part: string) => page.arrays.get(`object/${index}/${part}`);
      return new Piece(about, shape(about, array("points"), array("faces")), array("position")!, array("rotation")!);
    });
    if (this.pieces.length) this.add(...this.pieces);
  }

  paint(look: Theme): void {
    for (const piece of this.pieces) piece.paint(look);
  }

  /** `frame` is counted from the first one shown; what stands before a head, or as a wall before feet, turns to glass. */
  show(frame: number, heads: Vector3[], feet: Vector3[], eye: Vector3): void {
    for (const piece of this.pieces) {
      piece.place(frame);
      const spots = piece.top().z > TALL ? [...heads, ...feet] : heads;
      piece.glass(kindOf(piece.about.category).glass === true || spots.some((spot) => piece.hides(spot, eye)));
    }
  }
}

function shape({ shape, size }: Thing, points?: Numbers, faces?: Numbers): BufferGeometry {
  if (shape === "box") return new BoxGeometry(...size);
  if (shape === "cylinder") return new CylinderGeometry(size[0] / 2, size[0] / 2, size[2], 40).rotateX(Math.PI / 2);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points!.values, 3));
  if (faces) geometry.setIndex(new BufferAttribute(Uint32Array.from(faces.values), 1));
  return geometry;
}
