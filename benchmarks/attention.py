"""Attention between two people against their distance: Figure 4 of SoMoFormer, on the open test takes.

    python benchmarks/attention.py --data DIR [--run runs/ladder/3-0 …] [--picture docs/images/attention.png]

Of every pair of people in the composed scenes of three and in the couple's takes: how far apart their pelvises are in
the last frame seen, and which share of its attention a token of one gives to the tokens of the other, as a mean over
tokens, heads, layers and both ways. Prints Spearman's correlation with 95 % of a bootstrap over takes, for all pairs of
a scene of three, for strangers among them, and for the couple. A run keeps its torch weights; those of the models that
ship are read back from their graphs.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import onnx
import torch
from matplotlib.figure import Figure
from onnx import numpy_helper
from torch import Tensor, nn

from motioncast.benchmarks.protocols import windows_of
from motioncast.benchmarks.scoring import sources_of
from motioncast.datasets.windows import COMPOSED, Windows
from motioncast.formats.files import atomic_write
from motioncast.inference.registry import load
from motioncast.inference.session import GraphForecaster
from motioncast.metrics.bootstrap import draws, units
from motioncast.models import build
from motioncast.training.recipe import read_recipe, read_run
from motioncast.training.weights import load_weights
from motioncast.training.windows_task import final

SHIPPED = ("somoformer", "somoformer-fast")
PELVIS = 0
SCENES = 16
"""Scenes of a pass: at the paper's size their attention is 110 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs of people of a benchmark.

    Attributes:
        scene: Number of the window of each pair.
        distance_m: Between the pelvises in the last frame seen.
        attention: Share of attention from one to the other.
        couple: Whether the two dance together.
        drawn: How often each window counts in each resampling of the takes, all windows once first.
    """

    scene: np.ndarray
    distance_m: np.ndarray
    attention: np.ndarray
    couple: np.ndarray
    drawn: np.ndarray

    def correlation(self, chosen: np.ndarray) -> tuple[float, float, float]:
        """Spearman's correlation of the chosen pairs, and its 95 % interval."""
        weights = self.drawn[:, self.scene[chosen]]
        values = spearman(self.distance_m[chosen], self.attention[chosen], weights[weights.any(1)])
        return float(values[0]), *np.nanpercentile(values[1:], (2.5, 97.5)).tolist()


def spearman(x: np.ndarray, y: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Correlation of ranks where values count ``(draws, values)`` times, ``(draws,)``."""

    def ranks(values: np.ndarray) -> np.ndarray:
        order = values.argsort()
        counted = weights[:, order]
        ranked = np.empty_like(weights)
        ranked[:, order] = counted.cumsum(1) - counted / 2
        return ranked - (ranked * weights).sum(1, keepdims=True) / weights.sum(1, keepdims=True)

    a, b = ranks(x), ranks(y)
    products = [(weights * one * other).sum(1) for one, other in ((a, b), (a, a), (b, b))]
    return products[0] / np.sqrt(products[1] * products[2])


def shipped(name: str) -> nn.Module:
    """The torch model of a graph that ships; what the exporter left without a name stands in the model's order.

    Raises:
        ValueError: If it answers otherwise than the graph.
    """
    recipe = read_recipe(name)
    model = build(recipe.model, recipe.sizes).eval()
    tensors = onnx.load(str(resources.files("motioncast") / "weights" / f"{name}.onnx")).graph.initializer
    arrays = {tensor.name.removesuffix(".half"): numpy_helper.to_array(tensor) for tensor in tensors}
    named = {name.removeprefix("model."): array for name, array in arrays.items() if name.startswith("model.")}
    others = iter([unfolded(name, array) for name, array in arrays.items() if name.startswith("onnx::")])
    state = model.state_dict()
    for entry, value in state.items():
        array = named[entry] if entry in named else next(others)
        state[entry] = torch.from_numpy(array.astype(np.float32)).reshape(value.shape)
    model.load_state_dict(state)
    forecaster = load(name)
    assert isinstance(forecaster, GraphForecaster)
    card = forecaster.card
    history = torch.randn(1, card.history, 3, len(card.joints), 3, generator=torch.Generator().manual_seed(0))
    observed = torch.ones(history.shape[:-1], dtype=torch.bool)
    with torch.no_grad():
        answer = final(model(history, observed)).numpy()
    if np.abs(answer - forecaster.run(history.numpy(), observed.numpy())).max() > 1e-3:
        raise ValueError(f"the weights of {name} were read in another order than its graph has; adapt unfolded()")
    return model


def unfolded(name: str, array: np.ndarray) -> np.ndarray:
    """A tensor as the model holds it: the exporter transposes what is multiplied and what is split."""
    if "MatMul" in name:
        return array.T
    return array.swapaxes(1, 3) if "Split" in name else array


def attention(model: nn.Module, history: Tensor, observed: Tensor) -> Tensor:
    """Share of the attention of person i's tokens that goes to person k's, ``(B, P of i, P of k)``."""
    layers: list[Tensor] = []
    model(history, observed, layers)
    batch, _, people, joints = observed.shape
    shares = []
    for weights in layers:
        heads = weights.mean(1)
        if weights.shape[-1] == people * 3 * joints:  # a token a coordinate, all people in one sequence
            tokens = heads.view(batch, people, 3 * joints, people, 3 * joints)
            shares.append(tokens.sum(-1).mean(2))
        else:  # a sequence a person: a token a joint, then one for each other person; mirror images may follow
            shares.append(heads[: batch * people, :joints, joints:].mean(1).view(batch, people, people))
    return torch.stack(shares).mean(0)


@torch.no_grad()
def pairs_of(model: nn.Module, benchmark: str, data: Path) -> Pairs:
    """All pairs of a benchmark's test windows in which both are seen in the last frame."""
    protocol, windows = windows_of(benchmark, data)
    positions, observed = (torch.from_numpy(array) for array in windows.past)
    shares = torch.cat([
        attention(model, positions[start : start + SCENES], observed[start : start + SCENES])
        for start in range(0, len(windows), SCENES)
    ]).numpy()  # fmt: skip
    people = shares.shape[1]
    one, other = np.triu_indices(people, 1)
    pelvis = windows.past[0][:, -1, :, PELVIS]
    present = windows.past[1][:, -1, :, PELVIS]
    scene, pair = np.nonzero(present[:, one] & present[:, other])
    _, owners = units(sources_of(protocol, windows))
    drawn = draws(owners)
    return Pairs(
        scene,
        np.linalg.norm(pelvis[:, one] - pelvis[:, other], axis=-1)[scene, pair],
        ((shares + shares.transpose(0, 2, 1)) / 2)[:, one, other][scene, pair],
        _dances(windows)[:, one, other][scene, pair],
        np.concatenate([np.ones((1, len(windows))), drawn[drawn.any(1)]]),
    )


def _dances(windows: Windows) -> np.ndarray:
    """Who dances with whom, ``(windows, P, P)``: the last two people where a scene has a take less than people."""
    people = windows.positions.shape[2]
    together = np.zeros((len(windows), people, people), bool)
    with_couple = [len(names.split(COMPOSED)) < people for names in windows.takes]
    together[with_couple, -2, -1] = True
    return together


def draw(panels: dict[str, Pairs], path: Path) -> None:
    """A panel a model: pairs of the scenes of three as dots, the median of tenths of them as a line."""
    figure = Figure(figsize=(3.2 * len(panels), 3), layout="constrained")
    for axes, (name, pairs) in zip(np.atleast_1d(figure.subplots(1, len(panels))), panels.items(), strict=True):
        for kind, colour, label in ((~pairs.couple, "tab:blue", "strangers"), (pairs.couple, "tab:orange", "couple")):
            axes.scatter(pairs.distance_m[kind], 100 * pairs.attention[kind], s=1.5, color=colour, label=label)
        tenths = np.array_split(pairs.distance_m.argsort(), 10)
        x, y = ([np.median(values[tenth]) for tenth in tenths] for values in (pairs.distance_m, 100 * pairs.attention))
        axes.plot(x, y, color="black", linewidth=1.5, label="median")
        rho, low, high = pairs.correlation(np.ones(len(pairs.scene), bool))
        axes.set(xlabel="distance (m)", ylim=(0, None))
        axes.set_title(f"{name}\nrank correlation {rho:.2f} ({low:.2f} to {high:.2f})", fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
    figure.axes[0].set_ylabel("attention to the other (%)")
    figure.axes[0].legend(frameon=False, fontsize=8, markerscale=3)
    with atomic_write(path) as temporary:
        figure.savefig(temporary, dpi=90)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--run", type=Path, nargs="*", default=[], help="folders of further runs")
    parser.add_argument("--picture", type=Path, help="picture to write; its suffix tells the format")
    asked = parser.parse_args()
    models = {name: shipped(name) for name in SHIPPED}
    for run in asked.run:
        recipe = read_run(run)
        models[recipe.name] = load_weights(build(recipe.model, recipe.sizes), run / "best.pt")
    print("| model | pairs | n | median distance | median attention | rank correlation | 95 % |")
    print("|---|---|---:|---:|---:|---:|---|")
    panels = {}
    for name, model in models.items():
        crowd, duet = (pairs_of(model, benchmark, asked.data) for benchmark in ("cmu-crowd", "cmu-duet"))
        panels[name] = crowd
        for label, pairs, chosen in (
            ("three people", crowd, np.ones(len(crowd.scene), bool)),
            ("strangers of three", crowd, ~crowd.couple),
            ("the couple of three", crowd, crowd.couple),
            ("the couple alone", duet, np.ones(len(duet.scene), bool)),
        ):
            rho, low, high = pairs.correlation(chosen)
            print(
                f"| {name} | {label} | {chosen.sum()} | {np.median(pairs.distance_m[chosen]):.2f} m | "
                f"{np.median(100 * pairs.attention[chosen]):.1f} % | {rho:.2f} | {low:.2f} to {high:.2f} |"
            )
    if asked.picture:
        draw(panels, asked.picture)


if __name__ == "__main__":
    main()
