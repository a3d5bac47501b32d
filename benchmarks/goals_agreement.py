"""How often two passes over characteristic moments agree: the rule's, and one by eye.

    python benchmarks/goals_agreement.py

The sample is 100 moments of the rule, drawn over the whole table. Around each a window of 2.4 s was cut whose place did
not tell where the moment is, and its skeletons were looked at as a strip of pictures every 0.13 s, from one side. Every
moment in which somebody is most articulated was marked, the strongest one as such (``data/cmu_goals_eye.tsv``).
``data/cmu_goals.tsv`` was corrected afterwards where the eye disagreed clearly; the rule's moments stay in it.
Chance is the agreement of marks that are moved around the circle of their window.
"""

from __future__ import annotations

import re

import numpy as np

from motioncast.datasets.cmu_goals import table
from motioncast.formats.moments_tsv import Moment, read_moments

WITHIN_S = 0.25
SAMPLE, SEED = 100, 100
WINDOW = re.compile(r"window (\d+), ([\d.]+) to ([\d.]+) s")


def main() -> None:
    rule = [moment for moment in read_moments(table()) if moment.source != "manual"]
    sampled = [rule[row] for row in np.random.default_rng(SEED).permutation(len(rule))[:SAMPLE]]
    windows: dict[int, list[Moment]] = {}
    for mark in read_moments(table().with_name("cmu_goals_eye.tsv")):
        windows.setdefault(int(window(mark)[1]), []).append(mark)
    marked = {
        number: [mark.second for mark in marks if mark.source == "manual"] for number, marks in sorted(windows.items())
    }
    strongest = [mark for marks in windows.values() for mark in marks if mark.note.endswith("most articulated")]
    of_person = {name: [moment.second for moment in rule if moment.person == name] for name in {m.person for m in rule}}

    confirmed = sum(near(moment.second, marked[number]) for number, moment in enumerate(sampled))
    found = sum(near(mark.second, of_person[mark.person]) for mark in strongest)
    everywhere = [near(mark.second, of_person[mark.person]) for marks in windows.values() for mark in marks
                  if mark.source == "manual"]  # fmt: skip
    random, by_chance = np.random.default_rng(0), []
    for number, moment in enumerate(sampled):
        start, end = map(float, window(windows[number][0]).groups()[1:])
        for shift in random.uniform(0, end - start, 100):
            by_chance.append(near(moment.second, [start + (t - start + shift) % (end - start) for t in marked[number]]))
    print(f"within {WITHIN_S} s of a mark of the eye: {confirmed} of {SAMPLE} sampled moments of the rule", end="")
    print(f" ({100 * np.mean(by_chance):.0f} by chance)")
    print(
        f"within {WITHIN_S} s of a moment of the rule: {found} of the {len(strongest)} strongest marks of the eye, ",
        end="",
    )
    print(f"{sum(everywhere)} of all {len(everywhere)}")


def window(mark: Moment) -> re.Match[str]:
    found = WINDOW.match(mark.note)
    assert found, mark
    return found


def near(second: float, others: list[float]) -> bool:
    return any(abs(second - other) <= WITHIN_S + 1e-3 for other in others)


if __name__ == "__main__":
    main()
