"""The kitchen grammar: endless cooks whose next action and next pose are known, to measure what joint forecasts gain.

No data is needed. ``dishes`` says what is done, ``figure`` and ``motion`` with what body and pose, ``sequences`` what a
camera sees of it. The truth behind the pixels is for measuring only.
"""

from motioncast.datasets.kitchen.dishes import LABELS, OBJECTS
from motioncast.datasets.kitchen.sequences import bank, sequence, sequences, uncoupled

__all__ = ["LABELS", "OBJECTS", "bank", "sequence", "sequences", "uncoupled"]
