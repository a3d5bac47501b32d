// The page of `motioncast annotate`: characteristic moments, accepted, moved, added or rejected by key.

import { onThemeChange } from "../theme";
import { keep, motion, motions, type Entry, type Motion } from "./desk";
import { Editing } from "./editing";
import { Timeline } from "./timeline";
import { View } from "./view";

declare global {
  interface Window { __annotate?: { ready: boolean; frame: () => number; name: () => string; saving: () => Promise<void> } }
}

const box = (id: string): HTMLElement => document.getElementById(id)!;

function complain(error: unknown): void {
  box("failed").textContent = `Not saved: ${(error as Error).message}`;
  box("failed").hidden = false;
}

async function start(): Promise<void> {
  let entries: Entry[] = await motions();
  let number = Math.max(entries.findIndex((entry) => entry.open > 0 || !entry.seen), 0);
  let shown: Motion | null = null;
  let editing: Editing | null = null;
  let frame = 0, person = 0, playing = false, stale = true;
  let saving: Promise<void> = Promise.resolve();
  let ahead: [number, Promise<Motion>] | null = null; // the next motion, asked for while this one is looked at
  const view = new View(document.getElementById("stage") as HTMLCanvasElement, () => { stale = true; });
  const seek = (to: number) => {
    frame = Math.min(Math.max(to, 0), shown!.shape[0] - 1);
    stale = true;
  };
  const timeline = new Timeline(box("time"), (to) => { playing = false; seek(to); });

  /** Changes are kept one after the other, in the order in which they were made. */
  const save = () => {
    const [where, what] = [number, editing!.moments];
    saving = saving.then(() => keep(where, what)).then(() => { box("failed").hidden = true; }, complain);
    refresh();
  };
  const refresh = () => {
    const moments = editing!.of(person);
    timeline.show(shown!.extents[person], moments, shown!.fps);
    const count = (source: string) => moments.filter((moment) => moment.source === source).length;
    box("name").textContent = shown!.name;
    box("place").textContent = `${number + 1} of ${entries.length}`;
    box("counts").textContent = `${count("auto")} to look at, ${count("accepted")} accepted, ${count("manual")} by hand, ${count("rejected")} rejected`;
    box("people").textContent = shown!.people.length > 1
      ? shown!.people.map((name, one) => `${one + 1} ${name}${one === person ? " (edited)" : ""}`).join("   ") : "";
    stale = true;
  };
  const open = async (which: number) => {
    await saving;
    number = (which + entries.length) % entries.length;
    shown = await (ahead?.[0] === number ? ahead[1] : motion(number));
    editing = new Editing(shown.moments, shown.fps, save);
    [person, playing] = [0, false];
    view.open(shown);
    seek(editing.of(person).find((moment) => moment.source === "auto")?.frame ?? 0);
    refresh();
    const following = (number + 1) % entries.length;
    ahead = following === number ? null : [following, motion(following)];
    ahead?.[1].catch(() => { ahead = null; }); // it is asked for again, and complained about, when it is opened
  };
  const next = async (step: number) => {
    if (step > 0) save(); // a motion that was passed by counts as looked at
    await saving;
    entries = await motions();
    await open(number + step);
  };
  const jump = (forward: boolean) => {
    const moment = editing!.beside(person, frame, forward);
    playing = false;
    if (moment) seek(moment.frame);
  };

  const keys: Record<string, (event: KeyboardEvent) => void> = {
    " ": () => { if (frame >= shown!.shape[0] - 1) seek(0); playing = !playing; },
    ArrowRight: (event) => { playing = false; seek(Math.round(frame) + (event.shiftKey ? 10 : 1)); },
    ArrowLeft: (event) => { playing = false; seek(Math.round(frame) - (event.shiftKey ? 10 : 1)); },
    Home: () => seek(0),
    End: () => seek(Infinity),
    n: () => jump(true),
    p: () => jump(false),
    a: () => { editing!.accept(person, frame); jump(true); },
    A: () => editing!.acceptAll(),
    m: () => editing!.move(person, Math.round(frame)),
    x: () => { editing!.reject(person, frame); jump(true); },
    i: () => editing!.insert(person, Math.round(frame)),
    u: () => editing!.undo(),
    Enter: () => void next(1).catch(complain),
    Backspace: () => void next(-1).catch(complain),
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !shown) return;
    const act = keys[event.key];
    if (act) act(event);
    else if (Number(event.key) >= 1 && Number(event.key) <= shown.people.length) { person = Number(event.key) - 1; refresh(); }
    else return;
    event.preventDefault();
    stale = true;
  });
  onThemeChange(() => { view.paint(); stale = true; });
  new ResizeObserver(() => { view.resize(); stale = true; }).observe(document.getElementById("stage")!);
  await open(number);

  let before = performance.now();
  const tick = (now: number) => {
    if (playing) {
      seek(frame + Math.min((now - before) / 1000, 0.25) * shown!.fps);
      if (frame >= shown!.shape[0] - 1) playing = false;
    }
    before = now;
    if (stale) {
      stale = false;
      const moment = editing!.at(person, Math.round(frame));
      const here = moment !== null && moment.frame === Math.round(frame) && moment.source !== "rejected";
      view.draw(frame, person, here);
      timeline.point(frame);
      box("clock").textContent = `${(frame / shown!.fps).toFixed(2)} s`;
      box("here").textContent = moment ? `${moment.source} at ${(moment.frame / shown!.fps).toFixed(2)} s` : "no moment here";
    }
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
  window.__annotate = { ready: true, frame: () => Math.round(frame), name: () => shown!.name, saving: () => saving };
}

start().catch((error: Error) => {
  box("failed").textContent = `This page cannot be shown: ${error.message}`;
  box("failed").hidden = false;
});
