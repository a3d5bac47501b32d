// The error beside the scene: mean distance of a joint from the truth, with the playhead in it.

import type { Curve, Description } from "./data";

const WIDTH = 320, LEFT = 46, RIGHT = 16, TOP = 8, BOTTOM = 20;
const NARROW = matchMedia("(max-width: 760px)");

function svg(name: string, attributes: Record<string, string | number>, parent?: Element): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, `${value}`);
  parent?.append(element);
  return element;
}

/** One unit for all errors that stand beside one another; metres only where centimetres say nothing. */
export function metres(value: number): string {
  return value < 9.995 ? `${Math.round(value * 100)} cm` : `${value.toFixed(1)} m`;
}

interface Row { curve: Curve; kind: string; value: HTMLElement }

export class Chart {
  private readonly drawing: SVGElement;
  private readonly rows: Row[];
  private readonly end: number;
  private readonly known: number; // the time up to which the truth is known; 0 where there is none
  private readonly peak: number;
  private playhead!: SVGElement;
  private dots: SVGElement[] = [];
  private height = 0;
  private most = 0;
  private time = 0;

  constructor(root: HTMLElement, about: Description, seek: (time: number) => void) {
    this.end = (about.frames - about.now) / about.fps;
    this.known = Math.max(about.truth - 1, 0) / about.fps;
    this.peak = Math.max(...about.curves.flatMap((curve) => curve.errors), 0.01);
    root.querySelector("h2")!.textContent = about.curvesTitle;
    this.drawing = svg("svg", { role: "img", "aria-label": about.curvesTitle }, root);
    this.rows = about.curves.map((curve, index) => this.row(curve, index));
    const list = root.querySelector("ul")!;
    for (const { value } of this.rows) list.append(value.parentElement!);
    const draw = () => { this.draw(); this.show(this.time); };
    NARROW.addEventListener("change", draw);
    draw();
    const jump = (event: PointerEvent) => {
      const box = this.drawing.getBoundingClientRect();
      const share = (((event.clientX - box.left) / box.width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
      seek(Math.min(Math.max(share, 0), 1) * this.end);
    };
    this.drawing.addEventListener("pointerdown", (event) => {
      this.drawing.setPointerCapture(event.pointerId);
      jump(event);
    });
    this.drawing.addEventListener("pointermove", (event) => { if (event.buttons) jump(event); });
  }

  /** A line of the legend: key, name, value at the playhead. */
  private row(curve: Curve, index: number): Row {
    const kind = `curve ${curve.kind} n${index}`;
    const [item, name, value] = ["li", "span", "b"].map((tag) => document.createElement(tag));
    item.className = kind;
    name.textContent = curve.name;
    const key = svg("svg", { viewBox: "0 0 18 6", class: "key" });
    svg("line", { x1: 0, x2: 18, y1: 3, y2: 3, class: kind }, key);
    item.append(key, name, value);
    return { curve, kind, value };
  }

  /** Axes and curves; flatter in a narrow window, which needs its height for the people. */
  private draw(): void {
    const { drawing } = this;
    this.height = NARROW.matches ? 104 : 150;
    const lines = NARROW.matches ? 3 : 4;
    const step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5].find((size) => this.peak / size <= lines) ?? 10;
    this.most = Math.ceil(this.peak / step) * step;
    const bottom = this.height - BOTTOM;
    drawing.replaceChildren();
    drawing.setAttribute("viewBox", `0 0 ${WIDTH} ${this.height}`);
    for (let value = 0; value <= this.most + 1e-9; value += step) {
      svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: this.y(value), y2: this.y(value), class: "grid" }, drawing);
      svg("text", { x: LEFT - 5, y: this.y(value) + 3, class: "upright" }, drawing).textContent =
        value === 0 ? "0" : metres(value);
    }
    const level = (time: number) => svg("text", { x: this.x(time), y: this.height - 5, class: "level" }, drawing);
    const second = [0.1, 0.2, 0.5, 1, 2, 5].find((size) => this.end / size <= 6) ?? 10;
    for (let time = second; time <= this.end + 1e-9; time += second) {
      level(time).textContent = `+${+time.toFixed(1)} s`;
    }
    level(0).textContent = "now";
    this.playhead = svg("line", { y1: TOP, y2: bottom, class: "playhead" }, drawing);
    for (const { curve, kind } of [...this.rows].reverse()) { // the model's own curve is drawn last, on top
      const points = curve.times.map((time, index) => `${this.x(time).toFixed(1)},${this.y(curve.errors[index]).toFixed(1)}`);
      svg("polyline", { points: points.join(" "), class: kind }, drawing);
    }
    this.dots = this.rows.map(({ curve, kind }) =>
      svg("circle", { r: curve.kind === "baseline" ? 2.5 : 4, class: `${kind} dot` }, drawing));
  }

  show(time: number): void {
    this.time = time;
    const place = this.x(Math.max(time, 0));
    this.playhead.setAttribute("x1", `${place}`);
    this.playhead.setAttribute("x2", `${place}`);
    this.rows.forEach(({ curve, value }, index) => {
      const error = time > 0 ? read(curve, time) : null;
      const over = error === null && curve.kind === "model" && this.known > 0 && time > this.known;
      value.classList.toggle("note", over);
      const missing = over ? `your recording ends at +${+this.known.toFixed(1)} s` : "–";
      value.textContent = error === null ? missing : metres(error);
      const dot = this.dots[index];
      dot.setAttribute("visibility", error === null ? "hidden" : "visible");
      if (error === null) return;
      dot.setAttribute("cx", `${place}`);
      dot.setAttribute("cy", `${this.y(error)}`);
    });
  }

  private x(time: number): number {
    return LEFT + (time / this.end) * (WIDTH - LEFT - RIGHT);
  }

  private y(value: number): number {
    return this.height - BOTTOM - (value / this.most) * (this.height - BOTTOM - TOP);
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
