// The error beside the scene: mean distance of a joint from the truth, with the playhead in it.

import type { Curve, Description } from "./data";

const WIDTH = 320, HEIGHT = 150, LEFT = 38, RIGHT = 16, TOP = 8, BOTTOM = 20;

function svg(name: string, attributes: Record<string, string | number>, parent?: Element): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, `${value}`);
  parent?.append(element);
  return element;
}

export function metres(value: number): string {
  return value < 0.995 ? `${Math.round(value * 100)} cm` : `${+value.toFixed(2)} m`;
}

export class Chart {
  private readonly playhead: SVGElement;
  private readonly rows: { curve: Curve; value: HTMLElement; dot: SVGElement }[] = [];
  private readonly end: number;
  private readonly most: number;

  constructor(root: HTMLElement, about: Description, seek: (time: number) => void) {
    this.end = (about.frames - about.now) / about.fps;
    const peak = Math.max(...about.curves.flatMap((curve) => curve.errors), 0.01);
    const step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5].find((size) => peak / size <= 4) ?? 10;
    this.most = Math.ceil(peak / step) * step;
    root.querySelector("h2")!.textContent = about.curvesTitle;
    const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": about.curvesTitle }, root);
    for (let value = 0; value <= this.most + 1e-9; value += step) {
      svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: this.y(value), y2: this.y(value), class: "grid" }, drawing);
      svg("text", { x: LEFT - 5, y: this.y(value) + 3, class: "upright" }, drawing).textContent =
        value === 0 ? "0" : metres(value);
    }
    const second = [0.1, 0.2, 0.5, 1, 2, 5].find((size) => this.end / size <= 6) ?? 10;
    for (let time = second; time <= this.end + 1e-9; time += second) {
      svg("text", { x: this.x(time), y: HEIGHT - 5, class: "level" }, drawing).textContent = `+${+time.toFixed(1)} s`;
    }
    svg("text", { x: LEFT, y: HEIGHT - 5, class: "level" }, drawing).textContent = "now";
    this.playhead = svg("line", { y1: TOP, y2: HEIGHT - BOTTOM, class: "playhead" }, drawing);
    const list = root.querySelector("ul")!;
    const ordered = [...about.curves].reverse(); // the model's own curve is drawn last, on top
    for (const curve of ordered) {
      const kind = `curve ${curve.kind} n${about.curves.indexOf(curve)}`;
      const points = curve.times.map((time, index) => `${this.x(time).toFixed(1)},${this.y(curve.errors[index]).toFixed(1)}`);
      svg("polyline", { points: points.join(" "), class: kind }, drawing);
      const dot = svg("circle", { r: curve.kind === "baseline" ? 2.5 : 4, class: `${kind} dot` }, drawing);
      const row = document.createElement("li");
      row.className = kind;
      const name = document.createElement("span"), value = document.createElement("b");
      name.textContent = curve.name;
      row.append(svg("svg", { viewBox: "0 0 18 6", class: "key" }), name, value);
      svg("line", { x1: 0, x2: 18, y1: 3, y2: 3, class: kind }, row.querySelector("svg")!);
      list.prepend(row);
      this.rows.push({ curve, value, dot });
    }
    const jump = (event: PointerEvent) => {
      const box = drawing.getBoundingClientRect();
      const share = (((event.clientX - box.left) / box.width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
      seek(Math.min(Math.max(share, 0), 1) * this.end);
    };
    drawing.addEventListener("pointerdown", (event) => {
      drawing.setPointerCapture(event.pointerId);
      jump(event);
    });
    drawing.addEventListener("pointermove", (event) => { if (event.buttons) jump(event); });
  }

  show(time: number): void {
    const place = this.x(Math.max(time, 0));
    this.playhead.setAttribute("x1", `${place}`);
    this.playhead.setAttribute("x2", `${place}`);
    for (const { curve, value, dot } of this.rows) {
      const error = time > 0 ? read(curve, time) : null;
      value.textContent = error === null ? "–" : metres(error);
      dot.setAttribute("visibility", error === null ? "hidden" : "visible");
      if (error === null) continue;
      dot.setAttribute("cx", `${place}`);
      dot.setAttribute("cy", `${this.y(error)}`);
    }
  }

  private x(time: number): number {
    return LEFT + (time / this.end) * (WIDTH - LEFT - RIGHT);
  }

  private y(value: number): number {
    return HEIGHT - BOTTOM - (value / this.most) * (HEIGHT - BOTTOM - TOP);
  }
}

/** The value of a curve at a time; null behind its end. */
function read(curve: Curve, time: number): number | null {
  const next = curve.times.findIndex((other) => other >= time - 1e-6);
  if (next < 0) return null;
  if (next === 0) return curve.errors[0] * Math.min(time / curve.times[0], 1);
  const share = (time - curve.times[next - 1]) / (curve.times[next] - curve.times[next - 1]);
  return curve.errors[next - 1] * (1 - share) + curve.errors[next] * share;
}
