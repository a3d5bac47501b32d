"""Objects: what may be built, how they move with a scene, their distances and their codes."""

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core import rotation
from motioncast.core.basis_points import POINTS, basis_points, codes
from motioncast.core.resample import resample
from motioncast.core.scene import Scene, join
from motioncast.core.scene_object import CATEGORIES, SceneObject
from motioncast.core.shapes import signed_distance, surface_distance
from motioncast.core.skeletons import MRT15
from motioncast.errors import SceneError
from motioncast.formats import npz
from motioncast.formats.load import load_scene

TURN = rotation.from_axis_angle(np.array([0.0, 0.0, 0.7]))
BOX = SceneObject("table", "table", "box", (1.6, 0.8, 0.7), (2.0, -1.0, 0.35), TURN)
SHIFT = np.array([5, 6, 0])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"category": "throne"}, "use one of whiteboard"),
        ({"shape": "sphere"}, "use one of box"),
        ({"size": (160.0, 80.0, 70.0)}, "expected metres"),
        ({"size": (0.0, 0.0, 0.0)}, "above 0"),
        ({"size": (1.0, np.nan, 1.0)}, "not finite"),
        ({"size": (1.0, 1.0)}, "expected"),
        ({"shape": "points"}, "at least one point"),
        ({"shape": "points", "points": np.zeros((0, 3))}, "at least one point"),
        ({"shape": "mesh", "points": CORNERS, "faces": FACES + 2}, "triangles"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(change, told):
    with pytest.raises(SceneError, match=told):
        replace(BOX, **change)


def test_box_distance_is_that_to_many_points_of_its_surface():
    random = np.random.default_rng(0)
    share = random.uniform(-0.5, 0.5, (60_000, 3))
    side = random.integers(0, 3, 60_000)
    share[np.arange(60_000), side] = np.sign(share[np.arange(60_000), side]) * 0.5
    surface = BOX.outward(share * BOX.size)
    points = random.normal((2, -1, 0.4), 0.8, (40, 3))
    naive = np.linalg.norm(points[:, None] - surface, axis=-1).min(1)
    np.testing.assert_allclose(surface_distance(BOX, points), naive, atol=0.012)


def test_a_mesh_of_a_box_has_the_distances_of_the_box_outside():
    shape = SceneObject("cube", "table", "box", (1, 1, 1))
    signs = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    mesh = SceneObject("cube", "table", "mesh", points=signs, faces=np.array(faces))
    points = np.random.default_rng(1).normal(0, 1, (200, 3))
    np.testing.assert_allclose(surface_distance(mesh, points), surface_distance(shape, points), atol=1e-6)


def test_a_cylinder_is_round_and_a_cloud_is_its_points():
    stool = SceneObject("stool", "sittable", "cylinder", (0.4, 0.4, 0.5), (1, 1, 0.25), TURN)
    around = np.array([[1 + 0.3 * np.cos(a), 1 + 0.3 * np.sin(a), 0.25] for a in np.linspace(0, 6, 9)])
    np.testing.assert_allclose(signed_distance(stool, around), 0.1, atol=1e-6)
    cloud = SceneObject("cloud", "occluder", "points", points=CORNERS, position=(1, 0, 0))
    assert signed_distance(cloud, np.array([[3.0, 0, 0]])) == pytest.approx([1.0])


def test_codes_do_not_change_when_the_world_moves_and_turns():
    origin, across = np.array([[0.3, 0.2, 0.0], [2.0, 1.0, 0.0]]), np.array([[1.0, 0.0], [0.6, 0.8]])
    seen = codes([BOX], origin, across)
    assert seen.shape == (2, 1, POINTS + 13)
    assert np.abs(seen[0] - seen[1]).max() > 0.5
    turned = rotation.multiply(TURN, BOX.rotation)
    moved = replace(BOX, position=rotation.rotate(TURN, BOX.position) + SHIFT, rotation=turned)
    there = rotation.rotate(TURN, origin) + SHIFT
    heading = rotation.rotate(TURN, np.pad(across, ((0, 0), (0, 1))))[:, :2]
    np.testing.assert_allclose(codes([moved], there, heading), seen, atol=1e-5)


def test_basis_points_follow_the_published_law():
    points = basis_points()
    assert points[:, :2].std(0) == pytest.approx([2, 2], abs=0.1)
    assert points[:, 2].mean() == pytest.approx(0.798, abs=0.03)
    assert len(CATEGORIES) == 13


def moving_scene() -> Scene:
    path = np.linspace(0, 1, 60)[:, None] * np.array([1.0, 0, 0])
    ball = SceneObject("cup", "kettle", "cylinder", (0.1, 0.1, 0.2), path)
    mesh = SceneObject("rock", "occluder", "mesh", points=CORNERS, faces=FACES, role="decoy")
    return Scene(np.zeros((60, 1, 15, 3)), MRT15, 60, objects=(ball, BOX, mesh), floor_m=0.0)


def test_objects_go_with_the_frames_of_their_scene():
    scene = moving_scene()
    assert scene[10:20].objects[0].position[0, 0] == pytest.approx(10 / 59)
    slow = resample(scene, 20)
    assert slow.objects[0].position[-1, 0] == 1
    assert slow.objects[0].frames == slow.frames
    assert join([scene, replace(scene, objects=())]).objects == scene.objects
    with pytest.raises(SceneError, match="moves for 60 frames"):
        replace(scene, positions=scene.positions[:5], observed=scene.observed[:5])


def test_a_scene_file_keeps_objects_and_floor(tmp_path):
    scene = moving_scene()
    npz.write(scene, tmp_path / "room.npz")
    back = load_scene(tmp_path / "room.npz")
    assert back.floor_m == 0
    for one, other in zip(scene.objects, back.objects, strict=True):
        assert (one.name, one.category, one.shape, one.role) == (other.name, other.category, other.shape, other.role)
        for part in ("size", "position", "rotation", "points", "faces"):
            np.testing.assert_array_equal(getattr(one, part), getattr(other, part))
