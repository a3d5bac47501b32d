"""Furnished rooms full of people, composed from real takes; see ``docs/rooms.md``."""

from motioncast.datasets.rooms.check import Check as Check
from motioncast.datasets.rooms.check import check as check
from motioncast.datasets.rooms.compose import Room as Room
from motioncast.datasets.rooms.compose import rooms as rooms
from motioncast.datasets.rooms.events import Event as Event
from motioncast.datasets.rooms.samples import Sample as Sample
from motioncast.datasets.rooms.samples import windows as windows
