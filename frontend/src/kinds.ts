// What things can be: a word and a calm colour for each category; `glass` are those that would hide people.

import { Color } from "three";

interface Kind { word: string; color: string; glass?: boolean }

const KINDS: Record<string, Kind> = {
  table: { word: "table", color: "#dcc29a" },
  sittable: { word: "seat", color: "#b4c69c" },
  cupboard: { word: "cupboard", color: "#cdc6bc" },
  drawer: { word: "drawer", color: "#d9b8a0" },
  sink: { word: "sink", color: "#a3cbd4" },
  dishwasher: { word: "dishwasher", color: "#a9bdd6" },
  microwave: { word: "microwave", color: "#b3aad0" },
  kettle: { word: "kettle", color: "#d0a9c4" },
  coffee_machine: { word: "coffee machine", color: "#b09a8a" },
  whiteboard: { word: "whiteboard", color: "#f4f7fa" },
  trash: { word: "bin", color: "#a7b0a9" },
  occluder: { word: "wall", color: "#aab4be", glass: true },
  out_of_bound: { word: "off limits", color: "#dd9f97", glass: true },
};

export function kindOf(category: string): Kind {
  return KINDS[category] ?? { word: category, color: "#c4c8cc" };
}

/** The colour of a category; furniture is darker at night. */
export function kindColor(category: string, dark: boolean): Color {
  const color = new Color(kindOf(category).color);
  return dark ? color.multiplyScalar(0.4) : color;
}
