"""The card of a model: what it takes, what it gives, where it comes from, how well it does."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SKELETONS
from motioncast.errors import InputError

_KINDS: dict[str, tuple[type, ...]] = {"str": (str,), "int": (int,), "float": (float, int), "bool": (bool,)}
"""What JSON may give for a field, by its annotation; all others are mappings."""


@dataclass(frozen=True, slots=True)
class ModelCard:
    """What a model takes, what it gives, where it comes from and how well it does.

    Attributes:
        name: Name by which it is loaded.
        system: The system that it implements, such as ``SoMoFormer``.
        task: What it answers: ``forecast`` for positions ahead, ``goals`` for poses, ``actions`` for steps.
        skeleton: Name of its skeleton (``core.skeletons.SKELETONS``), or ``any``.
        history: Frames that it reads.
        horizon: Frames that it answers in one pass.
        fps: Its frame rate.
        people: Most people that it takes.
        parameters: Number of trained parameters.
        stochastic: Whether several samples differ.
        diffusion: Of a model that denoises: ``steps`` and ``shift`` of its cosine schedule, and the ``sampler`` and
            number of ``sampling_steps`` that answer by default; empty of all others.
        needs: What it must be told besides: of steps, the ``labels`` and ``objects`` that it knows.
        source: Paper and equations.
        data: What it was trained on.
        licence: Licence of code, data and weights.
        limits: Where it fails.
        figures: Measured figures by name, with the command that prints them under ``command``.
        radius: Calibrated error radii in metres: level ("0.5", "0.9") -> [horizon][joint]; with ``n``.
        exceptions: Contract checks that the published design cannot hold: name -> reason.
        tolerance_m: How exactly the model holds its invariances.
        recipe: Name of the recipe that trained it.
        training: What that cost: ``scenes`` seen, ``minutes`` and ``device``.
        checksum: SHA-256 of the weights.
    """

    name: str
    system: str
    task: str
    skeleton: str
    history: int
    horizon: int
    fps: float
    people: int = 16
    parameters: int = 0
    stochastic: bool = False
    diffusion: Mapping[str, Any] = field(default_factory=dict)
    needs: Mapping[str, Any] = field(default_factory=dict)
    source: str = ""
    data: str = ""
    licence: str = ""
    limits: str = ""
    figures: Mapping[str, Any] = field(default_factory=dict)
    radius: Mapping[str, Any] = field(default_factory=dict)
    exceptions: Mapping[str, str] = field(default_factory=dict)
    tolerance_m: float = 1e-4
    recipe: str = ""
    training: Mapping[str, Any] = field(default_factory=dict)
    checksum: str = ""

    @property
    def joints(self) -> Skeleton:
        """The model's skeleton."""
        return SKELETONS[self.skeleton]

    def to_json(self) -> str:
        """The card as JSON text."""
        return json.dumps(asdict(self), indent=1, ensure_ascii=False)

    @classmethod
    def from_json(cls, text: str) -> ModelCard:
        """A card from JSON text.

        Raises:
            InputError: If the text is not a card.
        """
        try:
            values = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError(f"the model card is not JSON ({error}); expected the card that training writes") from None
        known = {entry.name for entry in fields(cls)}
        needed = {"name", "system", "task", "skeleton", "history", "horizon", "fps"}
        if not isinstance(values, dict) or not needed <= set(values) <= known:
            odd = sorted(set(values) - known) if isinstance(values, dict) else values
            wanted = sorted(needed)
            raise InputError(f"the model card has unknown or missing entries ({odd}); expected at least {wanted}")
        if values["skeleton"] not in (*SKELETONS, "any"):
            raise InputError(f'the model card names the skeleton "{values["skeleton"]}"; known: {sorted(SKELETONS)}')
        for entry in fields(cls):
            kinds = _KINDS.get(str(entry.type), (dict,))
            if entry.name in values and type(values[entry.name]) not in kinds:
                raise InputError(
                    f'the entry "{entry.name}" of the model card is {values[entry.name]!r:.40}; '
                    f"expected {' or '.join(kind.__name__ for kind in kinds)}"
                )
        return cls(**values)
