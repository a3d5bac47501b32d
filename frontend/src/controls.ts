// Buttons, sliders and keys; they change the state and show it.

import type { Description } from "./data";
import { kindOf } from "./kinds";
import { lanes, type Stay } from "./lanes";
import { CAMERAS, DOUBTS, futuresOf, type Layer, LOOKS, SPEEDS, type State } from "./state";
import { personColor } from "./theme";

const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

export class Controls {
  private readonly slider = get<HTMLInputElement>("time");
  private readonly speed = get<HTMLSelectElement>("speed");
  private readonly help = get<HTMLDialogElement>("help");

  /** `changed` is called after every change; a change of `jump` moved the playhead. */
  constructor(
    private readonly about: Description, private readonly stays: Stay[][], private readonly state: State,
    readonly first: number, readonly last: number, private readonly changed: (jump: boolean) => void,
  ) {
    this.fill();
    this.listen();
    this.show();
  }

  seek(time: number): void {
    this.state.time = Math.min(Math.max(time, this.first), this.last);
    this.changed(true);
  }

  private stop(time: number): void {
    this.state.playing = false;
    this.seek(time);
  }

  private play(): void {
    this.state.playing = !this.state.playing;
    if (this.state.playing && this.state.time >= this.last - 1e-6) this.state.time = this.first;
    this.changed(true);
  }

  private step(frames: number): void {
    this.stop((Math.round(this.state.time * this.about.fps) + frames) / this.about.fps);
  }

  private toggle(layer: Layer): void {
    if (!this.state.layers.delete(layer)) this.state.layers.add(layer);
    this.changed(false);
  }

  private choose<K extends "camera" | "look" | "doubt" | "future">(key: K, value: State[K]): void {
    this.state[key] = value;
    this.changed(false);
  }

  private next<K extends "look" | "doubt" | "future">(key: K, choices: readonly State[K][]): void {
    this.choose(key, choices[(choices.indexOf(this.state[key]) + 1) % choices.length]);
  }

  /** Everything that depends on the data alone. */
  private fill(): void {
    const { about } = this;
    const begin = 1 - about.now, end = about.frames - about.now;
    document.title = about.title;
    get("title").textContent = about.title;
    get("model").textContent = about.card.name;
    const people = get("people");
    about.people.forEach(({ id, guessed }, person) => {
      const item = document.createElement("li");
      item.textContent = guessed ? `${id} (simple guess)` : id;
      item.style.setProperty("--person", personColor(person).getStyle());
      people.append(item);
    });
    get("colors").style.background = this.stripes();
    document.querySelector<HTMLElement>("[data-layer=truth]")!.hidden = about.truth === 0;
    get("doubts").hidden = about.levels.length === 0;
    get("looks").hidden = about.bones === 0;
    get("inside").hidden = about.objects.length === 0;
    get("aims").hidden = !about.goals;
    this.futures();
    this.kinds();
    get("levels").textContent = about.levels.map((level) => `${Math.round(Number(level) * 100)} %`).join(" and ");
    Object.assign(this.slider, { min: `${this.first}`, max: `${this.last}`, step: `${1 / about.fps / 8}` });
    const gaps = this.stays.some((own) => own.length !== 1 || own[0][0] > begin || own[0][1] < end);
    const count = Math.max(this.stays.length, 1);
    const lane = gaps ? Math.min(Math.max(Math.floor(36 / count), 2), 6) : Math.max(Math.ceil(8 / count), 1);
    this.slider.style.setProperty("--tall", `${lane * count}px`);
    this.slider.style.setProperty("--lanes", lanes(this.stays, begin, end, gaps));
    for (const speed of SPEEDS) this.speed.append(new Option(`${speed}×`, `${speed}`));
    for (const warning of about.warnings) {
      const item = document.createElement("li");
      item.textContent = warning;
      get("warnings").append(item);
    }
    const { card } = about;
    get("about-model").textContent = [
      `${card.name} (${card.system})`, card.parameters ? `${(card.parameters / 1e6).toFixed(1)} M parameters` : "",
      card.data, card.licence,
    ].filter(Boolean).join(" · ");
    this.ticks();
  }

  /** A button for each future, and one for all at once; how probable they are is said where they differ. */
  private futures(): void {
    const { weights } = this.about;
    get("futures").hidden = weights.length < 2;
    const differ = Math.max(...weights) - Math.min(...weights) > 0.005;
    for (const future of futuresOf(weights.length)) {
      const button = document.createElement("button");
      const weight = weights[Number(future) - 1];
      button.textContent = future === "all" ? "All" : future;
      button.dataset.set = `future:${future}`;
      button.title = weight === undefined ? "All at once (a)" : `Next one (v); ${Math.round(weight * 100)} % probable`;
      if (differ && weight !== undefined) button.append(small(`${Math.round(weight * 100)} %`));
      get("futures").querySelector("div")!.append(button);
    }
  }

  /** What the colours of things mean. */
  private kinds(): void {
    for (const category of new Set(this.about.objects.map((thing) => thing.category))) {
      const item = document.createElement("li");
      item.textContent = kindOf(category).word;
      item.style.setProperty("--kind", kindOf(category).color);
      get("kinds").append(item);
    }
  }

  /** The colours of the people, side by side. */
  private stripes(): string {
    const count = Math.min(this.about.people.length, 8);
    const stops = Array.from({ length: count }, (_, person) =>
      `${personColor(person).getStyle()} ${(100 * person) / count}% ${(100 * (person + 1)) / count}%`);
    return `linear-gradient(${stops.join(", ")})`;
  }

  private ticks(): void {
    const length = this.last - this.first;
    const second = [0.1, 0.2, 0.5, 1, 2, 5, 10].find((size) => length / size <= 9) ?? 20;
    for (let count = Math.ceil(this.first / second - 1e-9); count * second <= this.last + 1e-9; count++) {
      const time = +(count * second).toFixed(3);
      const tick = document.createElement("span");
      tick.textContent = time === 0 ? "now" : `${time < 0 ? "−" : "+"}${Math.abs(time)} s`;
      tick.className = time === 0 ? "now" : "";
      tick.style.left = `${((time - this.first) / length) * 100}%`;
      get("ticks").append(tick);
    }
  }

  private listen(): void {
    const press = (id: string, act: () => void) => get(id).addEventListener("click", act);
    press("play", () => this.play());
    press("back", () => this.step(-1));
    press("forward", () => this.step(1));
    press("loop", () => { this.state.loop = !this.state.loop; this.changed(false); });
    press("ask", () => this.help.showModal());
    press("close", () => this.help.close());
    press("more", () => { document.body.classList.toggle("open"); this.show(); });
    this.slider.addEventListener("input", () => this.stop(this.slider.valueAsNumber));
    this.speed.addEventListener("change", () => { this.state.speed = Number(this.speed.value); this.changed(false); });
    for (const button of document.querySelectorAll<HTMLElement>("button[data-layer]")) {
      button.addEventListener("click", () => this.toggle(button.dataset.layer as Layer));
    }
    for (const button of document.querySelectorAll<HTMLElement>("button[data-set]")) {
      const [key, value] = button.dataset.set!.split(":");
      button.addEventListener("click", () => this.choose(key as "camera", value as State["camera"]));
    }
    addEventListener("keydown", (event) => this.key(event));
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || this.help.open) return;
    const target = event.target as HTMLElement;
    if (target instanceof HTMLSelectElement || (target instanceof HTMLButtonElement && [" ", "Enter"].includes(event.key))) return;
    const camera = CAMERAS[Number(event.key) - 1];
    const acts: Record<string, () => void> = {
      " ": () => this.play(),
      ArrowLeft: () => this.step(event.shiftKey ? -10 : -1),
      ArrowRight: () => this.step(event.shiftKey ? 10 : 1),
      Home: () => this.stop(this.first),
      End: () => this.stop(this.last),
      n: () => this.stop(0),
      s: () => this.toggle("seen"),
      f: () => this.toggle("forecast"),
      t: () => this.toggle("truth"),
      p: () => this.toggle("paths"),
      w: () => this.toggle("stood"),
      o: () => this.toggle("things"),
      i: () => this.toggle("names"),
      g: () => this.toggle("goals"),
      h: () => this.toggle("heat"),
      v: () => this.next("future", futuresOf(this.about.weights.length)),
      a: () => this.choose("future", futuresOf(this.about.weights.length).at(-1)!),
      b: () => this.next("look", LOOKS),
      e: () => this.next("doubt", DOUBTS),
      l: () => get("loop").click(),
      "?": () => this.help.showModal(),
    };
    const act = camera ? () => this.choose("camera", camera) : acts[event.key] ?? acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** Shows the state on every button and slider. */
  show(): void {
    const { state, about } = this;
    const ahead = state.time > 1e-3;
    document.body.classList.toggle("ahead", ahead);
    get("caption").textContent = [
      "Grey: what was seen. Colour: what motioncast expects.",
      about.truth ? "See\u2011through: what really happened." : "",
      about.weights.length < 2 ? "" : state.future === "all"
        ? `Thin figures: ${about.weights.length - 1} other futures.` : `Future ${state.future} of ${about.weights.length}.`,
      about.goals && state.layers.has("goals") ? "Lines: the goals, bold where probable." : "",
      about.goals && state.layers.has("heat") ? "Clouds: where a hand may end, right in red, left in blue." : "",
      state.layers.has("stood") ? "Thin grey lines: where they stood at now." : "",
    ].filter(Boolean).join(" ");
    const whole = state.time.toFixed(2).replace("-", "−");
    get("clock").textContent = state.time > -0.005 && !ahead ? "now" : `${ahead ? "+" : ""}${whole} s`;
    get("phase").textContent = ahead ? "what motioncast expects" : "what was seen";
    this.slider.valueAsNumber = state.time;
    this.slider.setAttribute("aria-valuetext", `${state.time.toFixed(2)} seconds from now`);
    this.speed.value = `${state.speed}`;
    [...get("people").children].forEach((item, person) => {
      const frame = state.time * about.fps;
      item.classList.toggle("away", !this.stays[person].some(([from, to]) => from - 0.5 <= frame && frame <= to + 0.5));
    });
    get("play").classList.toggle("on", state.playing);
    get("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
    get("loop").setAttribute("aria-pressed", `${state.loop}`);
    get("more").setAttribute("aria-expanded", `${document.body.classList.contains("open")}`);
    for (const button of document.querySelectorAll<HTMLElement>("button[data-layer]")) {
      const on = state.layers.has(button.dataset.layer as Layer);
      button.setAttribute(button.role === "switch" ? "aria-checked" : "aria-pressed", `${on}`);
      if (button.role === "switch") button.textContent = on ? "On" : "Off";
    }
    for (const button of document.querySelectorAll<HTMLElement>("button[data-set]")) {
      const [key, value] = button.dataset.set!.split(":");
      button.setAttribute("aria-pressed", `${state[key as "camera"] === value}`);
    }
  }
}

function small(text: string): HTMLElement {
  const element = document.createElement("small");
  element.textContent = text;
  return element;
}
