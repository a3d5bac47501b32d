// The floor: z = 0, a grid of metres that fades into the sky.

import { Color, Mesh, PlaneGeometry, ShaderMaterial, Vector2 } from "three";
import type { Theme } from "./theme";

const VERTEX = `
varying vec2 spot;
void main() {
  vec4 place = modelMatrix * vec4(position, 1.0);
  spot = place.xy;
  gl_Position = projectionMatrix * viewMatrix * place;
}`;

const FRAGMENT = `
uniform vec3 ground;
uniform vec3 line;
uniform vec3 sky;
uniform vec2 middle;
uniform float reach;
varying vec2 spot;
void main() {
  vec2 away = abs(fract(spot - 0.5) - 0.5) / fwidth(spot);
  float grid = 1.0 - min(min(away.x, away.y), 1.0);
  float fade = 1.0 - smoothstep(0.35, 1.0, length(spot - middle) / reach);
  gl_FragColor = vec4(mix(sky, mix(ground, line, grid), fade), 1.0);
  #include <colorspace_fragment>
}`;

export class Floor extends Mesh<PlaneGeometry, ShaderMaterial> {
  constructor(middle: [number, number], reach: number) {
    super(new PlaneGeometry(2 * reach, 2 * reach), new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        ground: { value: new Color() }, line: { value: new Color() }, sky: { value: new Color() },
        middle: { value: new Vector2(...middle) }, reach: { value: reach },
      },
      depthWrite: false,
    }));
    this.position.set(middle[0], middle[1], 0);
    this.renderOrder = -1;
  }

  paint(theme: Theme): void {
    this.material.uniforms.ground.value.copy(theme.floor);
    this.material.uniforms.line.value.copy(theme.line);
    this.material.uniforms.sky.value.copy(theme.sky);
  }
}
