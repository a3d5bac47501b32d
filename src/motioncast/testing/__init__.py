"""The contract suite: checks that every model, shipped or yours, must hold."""

from motioncast.testing.contract import Check, check_forecaster, checks
from motioncast.testing.scenes import walkers

__all__ = ["Check", "check_forecaster", "checks", "walkers"]
