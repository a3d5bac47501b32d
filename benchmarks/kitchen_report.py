"""How much the kitchen grammar lets be known: what true labels and places of ten steps tell of the next ten.

    python benchmarks/kitchen_report.py [--sequences N]

A small network reads them and names every next step at once. It is no model of this package: no pose, no noise, no
roll-out. Its accuracy says what is there to be learnt, on sequences that it never saw.
"""

from __future__ import annotations

import argparse

import numpy as np
import torch
from torch import nn
from torch.nn.functional import cross_entropy, one_hot

from motioncast.datasets.kitchen.dishes import LABELS, PLACES, draw_objects, draw_steps

HISTORY, AHEAD, STEPS, BATCH = 10, 10, 1200, 256
READS = {"labels": (True, False), "labels and places": (True, True), "places": (False, True)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sequences", type=int, default=3000)
    asked = parser.parse_args()
    torch.manual_seed(0)
    train, held_out = windows(0, asked.sequences), windows(1, 300)
    for told, (what, count) in enumerate((("label", len(LABELS)), ("place", len(PLACES)))):
        for name, reads in READS.items():
            if (name == "places") == (what == "place") or name == "labels and places":
                right = " ".join(f"{100 * share:3.0f}" for share in accuracy(train, held_out, reads, told, count))
                print(f"{what} from {name:18} {right}  % right, 1 to {AHEAD} steps ahead", flush=True)


def windows(split: int, count: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Labels and places ``(windows, 2, 20)``, and which items there are."""
    steps, objects = [], []
    for number in range(count):
        random = np.random.default_rng([split, number])
        there = draw_objects(random)
        done = draw_steps(there, random)
        told = np.array([[LABELS.index(step.label), PLACES.index(step.place)] for step in done]).T
        starts = range(0, len(done) - HISTORY - AHEAD + 1, 2)
        steps += [told[:, start : start + HISTORY + AHEAD] for start in starts]
        objects += [there] * len(starts)
    return torch.tensor(np.array(steps)), torch.tensor(np.array(objects, np.float32))


def features(steps: torch.Tensor, objects: torch.Tensor, reads: tuple[bool, bool]) -> torch.Tensor:
    labels, places = (
        one_hot(steps[:, row, :HISTORY], count).float() for row, count in enumerate((len(LABELS), len(PLACES)))
    )
    parts = [part for part, read in zip((labels, places), reads, strict=True) if read]
    if all(reads):
        parts.append((labels[..., None] * places[..., None, :]).flatten(2))
    return torch.cat([objects, *(part.flatten(1) for part in parts)], 1)


def accuracy(train: tuple, held_out: tuple, reads: tuple[bool, bool], told: int, count: int) -> np.ndarray:
    """Share of right answers at each step ahead."""
    asked, truth = features(*held_out, reads), held_out[0][:, told, HISTORY:]
    network = nn.Sequential(
        nn.Linear(asked.shape[1], 256), nn.ReLU(), nn.Linear(256, 256), nn.ReLU(), nn.Linear(256, AHEAD * count)
    )
    optimiser = torch.optim.AdamW(network.parameters(), 2e-3, weight_decay=1e-2)
    pace = torch.optim.lr_scheduler.LinearLR(optimiser, 1.0, 0.0, STEPS)
    for _ in range(STEPS):
        rows = torch.randint(len(train[0]), (BATCH,))
        answer = network(features(train[0][rows], train[1][rows], reads)).view(-1, count)
        loss = cross_entropy(answer, train[0][rows, told, HISTORY:].flatten())
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        pace.step()
    with torch.no_grad():
        return (network(asked).view(-1, AHEAD, count).argmax(-1) == truth).float().mean(0).numpy()


if __name__ == "__main__":
    main()
