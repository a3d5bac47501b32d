"""What people do in a room, and the places where they touch something."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that one person does.

    Attributes:
        kind: ``sit``, ``reach``, ``write``, ``step`` or another of ``rooms.EVENTS``.
        person: Index of the person.
        start: First frame.
        end: End, exclusive.
        thing: Name of the object that it needs, or empty.
        point: Where the contact is, metres: under a sitting pelvis, in the palm of a reaching hand.
        outward: Horizontal angle of the direction from the thing to the person, radians.
        synthetic: Whether inverse kinematics made it, as against a real take.
    """

    kind: str
    person: int
    start: int
    end: int
    thing: str = ""
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    outward: float = 0.0
    synthetic: bool = False
