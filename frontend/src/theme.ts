// Colours of the world, light and dark; the rest of the page takes its colours from page.css.

import { Color } from "three";

export interface Theme { sky: Color; floor: Color; line: Color; ink: Color; seen: Color; shadow: Color; dark: boolean }

const dark = matchMedia("(prefers-color-scheme: dark)");

export function theme(): Theme {
  const colors = dark.matches
    ? ["#15181d", "#1b1f26", "#2c333d", "#f4f6f8", "#8b929c", "#000000"]
    : ["#eef0f2", "#f6f7f8", "#d5d9de", "#20262e", "#8d949d", "#1c2430"];
  const [sky, floor, line, ink, seen, shadow] = colors.map((text) => new Color(text));
  return { sky, floor, line, ink, seen, shadow, dark: dark.matches };
}

export function onThemeChange(act: () => void): void {
  dark.addEventListener("change", act);
}

const PEOPLE = ["#e8702a", "#1b86c9", "#16a085", "#c2417c", "#7a5cc9", "#b58a00", "#4f9d3a", "#c44536"];

/** A colour for each person: eight that are well told apart, then turns of the colour wheel. */
export function personColor(person: number): Color {
  if (person < PEOPLE.length) return new Color(PEOPLE[person]);
  return new Color().setHSL((person * 0.381966) % 1, 0.55, 0.5);
}
