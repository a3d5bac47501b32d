// Bare bones: solid sticks with balls for joints, or thin lines for the many samples.

import {
  BufferAttribute, BufferGeometry, Color, CylinderGeometry, DynamicDrawUsage, IcosahedronGeometry, InstancedBufferAttribute,
  InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, NotEqualStencilFunc, Object3D, Quaternion, ShaderMaterial, Vector3,
} from "three";
import { LIGHT } from "./body";
import type { Track } from "./track";

const VERTEX = `
attribute vec3 tint;
varying vec3 facing;
varying vec3 color;
varying vec3 toEye;
void main() {
  color = tint;
  facing = normalize(mat3(instanceMatrix) * normal);
  vec4 place = instanceMatrix * vec4(position, 1.0);
  toEye = cameraPosition - place.xyz;
  gl_Position = projectionMatrix * viewMatrix * place;
}`;

const FRAGMENT = `
varying vec3 facing;
varying vec3 color;
varying vec3 toEye;
${LIGHT}
void main() {
  gl_FragColor = vec4(lit(color, normalize(facing), normalize(toEye)), 1.0);
  #include <colorspace_fragment>
}`;

const UPRIGHT = new Vector3(0, 1, 0);

export class Sticks extends Object3D {
  private readonly sticks: InstancedMesh;
  private readonly balls: InstancedMesh;
  private readonly place = new Matrix4();
  private readonly turn = new Quaternion();
  private readonly from = new Vector3();
  private readonly to = new Vector3();

  /** `beside`: only beside solid bodies, not across them. */
  constructor(
    people: number, private readonly joints: number, private readonly bones: [number, number][], private readonly thick: number,
    beside: boolean,
  ) {
    super();
    const material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, stencilWrite: beside, stencilRef: 1, stencilFunc: NotEqualStencilFunc,
    });
    const make = (geometry: BufferGeometry, count: number) => {
      geometry.setAttribute("tint", new InstancedBufferAttribute(new Float32Array(count * 3), 3));
      const mesh = new InstancedMesh(geometry, material, count);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.renderOrder = beside ? 1 : 0;
      this.add(mesh);
      return mesh;
    };
    this.sticks = make(new CylinderGeometry(1, 1, 1, 6, 1, true), people * bones.length);
    this.balls = make(new IcosahedronGeometry(1, 1), people * joints);
  }

  /** Shows the people of a track for whom `color` gives one. */
  show(track: Track, color: (person: number) => Color | null): void {
    let sticks = 0, balls = 0;
    for (let person = 0; person < track.people; person++) {
      const tint = color(person);
      if (!tint) continue;
      for (const [joint, parent] of this.bones) {
        if (!track.sees(person, joint) || !track.sees(person, parent)) continue;
        this.from.fromArray(track.current, (person * this.joints + parent) * 3);
        this.to.fromArray(track.current, (person * this.joints + joint) * 3).sub(this.from);
        const length = this.to.length();
        this.turn.setFromUnitVectors(UPRIGHT, this.to.clone().divideScalar(Math.max(length, 1e-6)));
        this.from.addScaledVector(this.to, 0.5);
        this.place.compose(this.from, this.turn, new Vector3(this.thick, length, this.thick));
        this.put(this.sticks, sticks++, tint);
      }
      for (let joint = 0; joint < this.joints; joint++) {
        if (!track.sees(person, joint)) continue;
        this.from.fromArray(track.current, (person * this.joints + joint) * 3);
        const size = this.thick * 1.45;
        this.place.makeScale(size, size, size).setPosition(this.from);
        this.put(this.balls, balls++, tint);
      }
    }
    for (const [mesh, count] of [[this.sticks, sticks], [this.balls, balls]] as const) {
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = true;
      mesh.geometry.getAttribute("tint").needsUpdate = true;
    }
  }

  private put(mesh: InstancedMesh, index: number, tint: Color): void {
    mesh.setMatrixAt(index, this.place);
    mesh.geometry.getAttribute("tint").setXYZ(index, tint.r, tint.g, tint.b);
  }
}

/** Bones as lines, all people and samples in one draw. */
export class Lines extends LineSegments<BufferGeometry, LineBasicMaterial> {
  private used = 0;

  constructor(lines: number, opacity: number) {
    const geometry = new BufferGeometry();
    for (const name of ["position", "color"]) {
      const attribute = new BufferAttribute(new Float32Array(lines * 6), 3);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    super(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity, depthWrite: false }));
    this.frustumCulled = false;
  }

  begin(): void {
    this.used = 0;
  }

  draw(track: Track, bones: [number, number][], color: (person: number) => Color | null): void {
    const place = this.geometry.getAttribute("position") as BufferAttribute;
    const tints = this.geometry.getAttribute("color") as BufferAttribute;
    for (let person = 0; person < track.people; person++) {
      const tint = color(person);
      if (!tint) continue;
      for (const bone of bones) {
        if (!track.sees(person, bone[0]) || !track.sees(person, bone[1])) continue;
        for (const joint of bone) {
          const start = (person * track.joints + joint) * 3;
          place.setXYZ(this.used, track.current[start], track.current[start + 1], track.current[start + 2]);
          tints.setXYZ(this.used++, tint.r, tint.g, tint.b);
        }
      }
    }
  }

  end(): void {
    this.geometry.setDrawRange(0, this.used);
    for (const name of ["position", "color"]) this.geometry.getAttribute(name).needsUpdate = true;
  }
}
