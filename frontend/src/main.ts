// The page of a forecast: what was seen, what is expected, and what really happened.

import { Chart } from "./curve";
import { Controls } from "./controls";
import { readPage } from "./data";
import { staysOf } from "./lanes";
import { Stage } from "./stage";
import { readState, writeState } from "./state";
import { onThemeChange } from "./theme";

declare global {
  interface Window { __mc?: { ready: boolean; state: unknown; seek: (time: number) => void; colors: () => number } }
}

/** Fewer pixels for a machine that cannot keep up while it plays; a still picture is always sharp. */
class Pace {
  private share = 1;
  private slow = 0;

  sharpness(passed: number): number {
    this.slow = passed > 0.05 ? this.slow + 1 : Math.max(this.slow - 1, 0);
    if (this.slow > 8 && this.share > 0.5) {
      this.share = Math.max(this.share * 0.75, 0.5);
      this.slow = 0;
    }
    return this.share;
  }
}

async function start(): Promise<void> {
  const page = await readPage();
  const { about } = page;
  const first = (1 - about.now) / about.fps, last = (about.frames - about.now) / about.fps;
  const state = readState(first, last, about.weights.length);
  const canvas = document.getElementById("stage") as HTMLCanvasElement;
  const stage = new Stage(canvas, page);
  let stale = true, sudden = true, rewrite = 0;
  const pace = new Pace();

  const change = (jump: boolean) => {
    stale = true;
    sudden ||= jump;
    controls.show();
    chart?.show(state.time);
    clearTimeout(rewrite);
    if (!state.playing) rewrite = window.setTimeout(() => writeState(state), 250);
  };
  const controls = new Controls(about, staysOf(page), state, first, last, change);
  const errors = document.getElementById("errors")!;
  const chart = about.curves.length
    ? new Chart(errors, about, (time) => { state.playing = false; controls.seek(time); })
    : null;
  errors.hidden = chart === null;

  stage.eye.controls.addEventListener("change", () => { stale = true; });
  onThemeChange(() => { stage.paint(); change(false); });
  const box = (id: string) => document.getElementById(id)!.getBoundingClientRect();
  const resize = () => {
    document.body.style.setProperty("--errors", `${errors.offsetHeight}px`); // in narrow windows the clock stands on it
    // in small windows the clock stands at the bottom
    const low = Math.min(box("bar").top, box("now").top > canvas.clientHeight / 2 ? box("now").top : Infinity);
    const beside = canvas.clientWidth > 760;
    const top = low < box("bar").top && beside ? 0 : box(beside ? "now" : "top").bottom;
    stage.resize(top, canvas.clientHeight - low);
  };
  new ResizeObserver(() => { resize(); change(true); }).observe(canvas);
  resize();
  change(true);

  let before = performance.now();
  const tick = (now: number) => {
    // a page that slept does not jump
    const passed = Math.min((now - before) / 1000, 0.25);
    before = now;
    if (state.playing) {
      state.time += passed * state.speed;
      if (state.time >= last) {
        const again = state.loop;
        state.playing = again;
        state.time = again ? Math.max(first, -1.5) : last;
        sudden ||= again;
      }
      change(false);
    }
    const sharpness = state.playing ? pace.sharpness(passed) : 1;
    if (sharpness !== stage.sharpness) {
      stage.sharpen(sharpness);
      stale = true;
    }
    if (stale) {
      stale = false;
      stage.draw(state, sudden || !state.playing);
      sudden = false;
    }
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
  window.__mc = {
    ready: true, state, seek: (time) => { state.playing = false; controls.seek(time); },
    colors: () => { stage.draw(state, true); return stage.colorsDrawn(); },
  };
}

start().catch((error: Error) => {
  const message = document.getElementById("failed")!;
  message.textContent = `This page cannot be shown here: ${error.message}. A browser from 2023 or later with WebGL 2 is needed.`;
  message.hidden = false;
});
