// Bodies: one mesh, bent on the graphics card by a matrix for each bone.

import {
  AlwaysStencilFunc, BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, KeepStencilOp, Matrix4, Mesh,
  NotEqualStencilFunc, Quaternion, ReplaceStencilOp, ShaderMaterial, Vector3,
} from "three";
import type { Numbers, Page } from "./data";
import { between } from "./track";

const VERTEX = `
uniform mat4 bones[BONES];
attribute vec4 joint;
attribute vec4 share;
varying vec3 facing;
varying vec3 toEye;
void main() {
  mat4 bend = bones[int(joint.x)] * share.x + bones[int(joint.y)] * share.y
            + bones[int(joint.z)] * share.z + bones[int(joint.w)] * share.w;
  vec4 place = bend * vec4(position, 1.0);
  facing = normalize(mat3(bend) * normal);
  toEye = cameraPosition - place.xyz;
  gl_Position = projectionMatrix * viewMatrix * place;
}`;

// lit from above by a sky, from the side by a sun, and a little from where the reader stands
export const LIGHT = `
vec3 lit(vec3 color, vec3 n, vec3 eye) {
  float sky = 0.5 + 0.5 * n.z;
  float sun = max(dot(n, normalize(vec3(0.5, -0.6, 0.7))), 0.0);
  return color * (0.38 + 0.3 * sky + 0.3 * sun + 0.22 * max(dot(n, eye), 0.0));
}`;

const SOLID = `
uniform vec3 color;
varying vec3 facing;
varying vec3 toEye;
${LIGHT}
void main() {
  vec3 n = normalize(facing);
  vec3 eye = normalize(toEye);
  float rim = pow(1.0 - max(dot(n, eye), 0.0), 3.0);
  gl_FragColor = vec4(lit(color, n, eye) + 0.12 * rim, 1.0);
  #include <colorspace_fragment>
}`;

// see-through, a little darker where it is turned from the sky, with a soft outline
const GHOST = `
uniform vec3 color;
varying vec3 facing;
varying vec3 toEye;
void main() {
  vec3 n = normalize(facing);
  float rim = 1.0 - max(dot(n, normalize(toEye)), 0.0);
  gl_FragColor = vec4(color, 0.11 + 0.06 * (1.0 - n.z) + 0.45 * smoothstep(0.5, 1.0, rim));
  #include <colorspace_fragment>
}`;

/** Poses of bones over time: `rotations` (frames, people, bones, 4) wxyz and `heads` (frames, people, bones, 3). */
export class Poses {
  private readonly turn = new Quaternion();
  private readonly other = new Quaternion();
  private readonly head = new Vector3();
  private readonly across = new Matrix4();
  private readonly stretch: Matrix4[][];
  private readonly bones: number;
  private readonly people: number;

  constructor(private readonly rotations: Numbers, private readonly heads: Numbers, page: Page, readonly first: number) {
    [, this.people, this.bones] = rotations.shape;
    const rest = page.arrays.get("body/heads")!.values;
    const axes = page.arrays.get("body/axes")!.values;
    const scales = page.arrays.get("body/scales")!.values;
    this.stretch = Array.from({ length: this.people }, (_, person) => Array.from({ length: this.bones }, (_, bone) => {
      const [along, wide] = scales.subarray((person * this.bones + bone) * 2);
      const [x, y, z] = axes.subarray(bone * 3);
      const more = along - wide;
      const matrix = new Matrix4().set(
        wide + more * x * x, more * x * y, more * x * z, 0,
        more * x * y, wide + more * y * y, more * y * z, 0,
        more * x * z, more * y * z, wide + more * z * z, 0, 0, 0, 0, 1,
      );
      const [hx, hy, hz] = rest.subarray(bone * 3);
      return matrix.multiply(new Matrix4().makeTranslation(-hx, -hy, -hz));
    }));
  }

  /** Writes a matrix for each bone of a person. */
  read(frame: number, person: number, into: Matrix4[]): void {
    const { low, high, share } = between(frame - this.first, this.rotations.shape[0]);
    for (let bone = 0; bone < this.bones; bone++) {
      const a = (low * this.people + person) * this.bones + bone, b = (high * this.people + person) * this.bones + bone;
      const q = this.rotations.values, p = this.heads.values;
      this.turn.set(q[a * 4 + 1], q[a * 4 + 2], q[a * 4 + 3], q[a * 4]).normalize();
      this.other.set(q[b * 4 + 1], q[b * 4 + 2], q[b * 4 + 3], q[b * 4]).normalize();
      this.turn.slerp(this.other, share);
      this.head.set(p[a * 3], p[a * 3 + 1], p[a * 3 + 2]);
      for (const axis of [0, 1, 2]) {
        this.head.setComponent(axis, p[a * 3 + axis] * (1 - share) + p[b * 3 + axis] * share);
      }
      into[bone].makeRotationFromQuaternion(this.turn).setPosition(this.head);
      into[bone].multiply(this.across.copy(this.stretch[person][bone]));
    }
  }
}

/** The mesh that all bodies share. */
export function bodyGeometry(page: Page): BufferGeometry {
  const take = (name: string) => page.arrays.get(`body/${name}`)!.values;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(take("vertices"), 3));
  geometry.setIndex(new BufferAttribute(Uint16Array.from(take("faces")), 1));
  geometry.setAttribute("joint", new BufferAttribute(take("indices"), 4));
  geometry.setAttribute("share", new BufferAttribute(take("weights"), 4));
  geometry.computeVertexNormals();
  return geometry;
}

/**
 * A body; a ghost is drawn after the solid bodies and only beside them: lines across a solid body, in front of it or
 * where the two pass through one another, would read as scratches.
 */
export class BodyMesh extends Mesh<BufferGeometry, ShaderMaterial> {
  readonly bones: Matrix4[];

  constructor(geometry: BufferGeometry, bones: number, ghost: boolean) {
    const matrices = Array.from({ length: bones }, () => new Matrix4());
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: ghost ? GHOST : SOLID,
      defines: { BONES: bones },
      uniforms: { bones: { value: matrices }, color: { value: new Color() } },
      transparent: ghost,
      depthWrite: !ghost,
      side: ghost ? FrontSide : DoubleSide,
      stencilWrite: true,
      stencilRef: 1,
      stencilFunc: ghost ? NotEqualStencilFunc : AlwaysStencilFunc,
      stencilZPass: ghost ? KeepStencilOp : ReplaceStencilOp,
    });
    super(geometry, material);
    this.bones = matrices;
    this.frustumCulled = false;
    if (ghost) this.add(this.nearest());
  }

  /** The depth of the nearest surface, drawn first, so that a ghost does not show through itself. */
  private nearest(): Mesh {
    const depth = this.material.clone();
    depth.uniforms = this.material.uniforms;
    depth.colorWrite = false;
    depth.depthWrite = true;
    const mesh = new Mesh(this.geometry, depth);
    mesh.frustumCulled = false;
    mesh.renderOrder = 4;
    this.renderOrder = 5;
    return mesh;
  }

  paint(color: Color): void {
    this.material.uniforms.color.value.copy(color);
  }
}
