"""What will they do next? Forecasts of people's motion.

    import motioncast as mc

    scene = mc.load_scene("a.bvh", "b.bvh")
    forecast = mc.load("somoformer").forecast(scene, horizon_s=3.0)

Names are loaded when they are used: importing the package loads neither NumPy nor ONNX Runtime nor torch.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from motioncast.core.card import ModelCard as ModelCard
    from motioncast.core.forecast import Forecast as Forecast
    from motioncast.core.goal_poses import GoalPoses as GoalPoses
    from motioncast.core.scene import Scene as Scene
    from motioncast.core.scene import join as join
    from motioncast.core.skeleton import Skeleton as Skeleton
    from motioncast.errors import FormatError as FormatError
    from motioncast.errors import InputError as InputError
    from motioncast.errors import MotioncastError as MotioncastError
    from motioncast.formats.load import load_forecast as load_forecast
    from motioncast.formats.load import load_goals as load_goals
    from motioncast.formats.load import load_scene as load_scene
    from motioncast.formats.load import save_forecast as save_forecast
    from motioncast.formats.load import save_goals as save_goals
    from motioncast.formats.load import save_scene as save_scene
    from motioncast.inference.registry import list_models as list_models
    from motioncast.inference.registry import load as load
    from motioncast.view.page import write_page as write_page

__version__ = "0.1.0"

_PLACES = {
    "Forecast": "core.forecast",
    "FormatError": "errors",
    "GoalPoses": "core.goal_poses",
    "InputError": "errors",
    "ModelCard": "core.card",
    "MotioncastError": "errors",
    "Scene": "core.scene",
    "Skeleton": "core.skeleton",
    "join": "core.scene",
    "list_models": "inference.registry",
    "load": "inference.registry",
    "load_forecast": "formats.load",
    "load_goals": "formats.load",
    "load_scene": "formats.load",
    "save_forecast": "formats.load",
    "save_goals": "formats.load",
    "save_scene": "formats.load",
    "write_page": "view.page",
}

__all__ = sorted(_PLACES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'motioncast' has no attribute {name!r}")
    return getattr(import_module(f"motioncast.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
