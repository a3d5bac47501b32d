// The extent of a person over time, its moments, and the playhead.

import type { Moment } from "./desk";

const HEIGHT = 110, FOOT = 20;

export class Timeline {
  private readonly svg: SVGSVGElement;
  private readonly curve: SVGPathElement;
  private readonly marks: SVGGElement;
  private readonly head: SVGLineElement;
  private frames = 1;
  private most = 1;

  constructor(box: HTMLElement, seek: (frame: number) => void) {
    const make = <Name extends keyof SVGElementTagNameMap>(name: Name, kind: string): SVGElementTagNameMap[Name] => {
      const element = document.createElementNS("http://www.w3.org/2000/svg", name);
      element.setAttribute("class", kind);
      return element;
    };
    this.svg = make("svg", "timeline");
    this.curve = make("path", "extent");
    this.marks = make("g", "marks");
    this.head = make("line", "playhead");
    this.svg.append(this.curve, this.marks, this.head);
    box.append(this.svg);
    const point = (event: PointerEvent) => {
      const { left, width } = this.svg.getBoundingClientRect();
      seek(Math.round(Math.min(Math.max((event.clientX - left) / width, 0), 1) * (this.frames - 1)));
    };
    this.svg.addEventListener("pointerdown", (event) => { this.svg.setPointerCapture(event.pointerId); point(event); });
    this.svg.addEventListener("pointermove", (event) => { if (event.buttons) point(event); });
  }

  show(extent: number[], moments: Moment[], fps: number): void {
    this.frames = extent.length;
    this.most = Math.max(...extent, 0.1);
    this.svg.setAttribute("viewBox", `0 0 ${Math.max(this.frames - 1, 1)} ${HEIGHT}`);
    this.svg.setAttribute("preserveAspectRatio", "none");
    this.curve.setAttribute("d", `M${extent.map((value, frame) => `${frame} ${this.height(value).toFixed(1)}`).join("L")}`);
    this.marks.replaceChildren(...moments.flatMap((moment) => {
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      line.setAttribute("class", moment.source);
      const top = this.height(extent[Math.min(moment.frame, extent.length - 1)]);
      for (const [name, value] of [["x1", moment.frame], ["x2", moment.frame], ["y1", top - 14], ["y2", HEIGHT]] as const) {
        line.setAttribute(name, `${value}`);
      }
      line.append(Object.assign(document.createElementNS("http://www.w3.org/2000/svg", "title"), {
        textContent: `${(moment.frame / fps).toFixed(2)} s, ${moment.source}${moment.note && `: ${moment.note}`}`,
      }));
      return [line];
    }));
  }

  point(frame: number): void {
    for (const [name, value] of [["x1", frame], ["x2", frame], ["y1", 0], ["y2", HEIGHT]] as const) {
      this.head.setAttribute(name, `${value}`);
    }
  }

  private height(extent: number): number {
    return HEIGHT - FOOT - (extent / this.most) * (HEIGHT - FOOT - 18);
  }
}
