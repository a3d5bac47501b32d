// Round marks: soft shadows on the floor, rings of doubt on the floor, balls of doubt around joints.

import {
  Color, CustomBlending, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, NormalBlending, OneFactor,
  PlaneGeometry, ShaderMaterial,
} from "three";

const VERTEX = `
attribute vec4 place; // middle and radius
attribute vec4 tint; // colour and strength
varying vec2 within;
varying vec4 color;
varying float radius;
void main() {
  within = position.xy;
  color = tint;
  radius = place.w;
  vec3 side = vec3(1.0, 0.0, 0.0), top = vec3(0.0, 1.0, 0.0);
  #ifdef UPRIGHT
  side = vec3(viewMatrix[0][0], viewMatrix[1][0], viewMatrix[2][0]);
  top = vec3(viewMatrix[0][1], viewMatrix[1][1], viewMatrix[2][1]);
  #endif
  vec3 spot = place.xyz + place.w * (side * position.x + top * position.y);
  gl_Position = projectionMatrix * viewMatrix * vec4(spot, 1.0);
}`;

const FRAGMENT = `
varying vec2 within;
varying vec4 color;
varying float radius;
void main() {
  float away = length(within);
  float grain = fwidth(away) * radius;
  if (away > 1.0) discard;
  #ifdef SOFT
  float strength = (1.0 - away) * (1.0 - away);
  #else
  float edge = (1.0 - away) * radius;
  float width = max(WIDTH, 1.8 * grain);
  float strength = FILL + (1.0 - FILL) * (1.0 - smoothstep(width * 0.6, width, edge));
  #endif
  gl_FragColor = vec4(color.rgb, color.a * strength);
  #include <colorspace_fragment>
}`;

export type Kind = "shadow" | "ring" | "ball";

export class Discs extends Mesh<InstancedBufferGeometry, ShaderMaterial> {
  private used = 0;

  constructor(count: number, kind: Kind) {
    const geometry = new InstancedBufferGeometry();
    const plane = new PlaneGeometry(2, 2);
    geometry.setIndex(plane.getIndex());
    geometry.setAttribute("position", plane.getAttribute("position"));
    for (const name of ["place", "tint"]) {
      const attribute = new InstancedBufferAttribute(new Float32Array(count * 4), 4);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    const defines = {
      shadow: { SOFT: 1 },
      ring: { FILL: "0.16", WIDTH: "0.018" },
      ball: { FILL: "0.12", WIDTH: "0.007", UPRIGHT: 1 },
    }[kind];
    super(geometry, new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, defines, depthWrite: false, transparent: kind !== "shadow",
      blending: kind === "shadow" ? CustomBlending : NormalBlending, blendSrcAlpha: OneFactor,
    }));
    this.frustumCulled = false;
    this.renderOrder = { shadow: -0.5, ring: 1, ball: 3 }[kind]; // a foot that sinks in is not in its own shadow
  }

  begin(): void {
    this.used = 0;
  }

  mark(x: number, y: number, z: number, radius: number, color: Color, strength: number): void {
    this.geometry.getAttribute("place").setXYZW(this.used, x, y, z, radius);
    this.geometry.getAttribute("tint").setXYZW(this.used++, color.r, color.g, color.b, strength);
  }

  end(): void {
    this.geometry.instanceCount = this.used;
    for (const name of ["place", "tint"]) this.geometry.getAttribute(name).needsUpdate = true;
  }
}
