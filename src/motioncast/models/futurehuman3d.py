"""FutureHuman3D: the next action and the 3D pose that is characteristic of it, step by step, from 2D observations.

Paper: Diller, Funkhouser, Dai, "FutureHuman3D: Forecasting Complex Long-Term 3D Human Behavior from Video
Observations", CVPR 2024, Sec. 3 (layers, losses, bank of poses), and its appendix for the critic and two people.

Past poses in the image, past actions and the objects seen at the start are encoded apart, joined to one code, and
decoded to the next action and the next pose. No 3D pose of the video is known: the pose is projected into the image and
compared there (Eq. 2, 3), and a critic with a bank of unrelated real poses keeps it human. An answer is appended to
the past, and the network is asked again.

The published drawing of layer sizes is an image that no text gives; sizes are ours, kinds of layers the paper's. What
the text leaves open is decided so:

- Poses are seen from the neck, in metres at the person's depth. That follows from the size of the trunk in the past
  (``core/upper_body.py``), so that nothing of the future is looked at.
- The critic learns with a gradient penalty.
- Of a growing share of the windows (in the end 0.3) the last steps of the past are the model's own answers.
- Where joints are not seen they are zero and told to be missing, like steps before the first.

Two presets. ``paper`` compares in pixels, with weights 1e6, 1 and 1, over the ten steps of its cooking data.
``motioncast`` compares in tenths of a metre, and reads each past step, pose and action, by layers that all steps share
before they are joined: what is taken where means the same whenever it was.

Two people (appendix): each has encoders and decoders of its own; a code joined by social pooling tells each of the
other: where it stands, and the strongest of its features (Social GAN).

Shapes: B windows, H past steps, P people, J = 9 joints, A actions, O objects, Z numbers of noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import torch
from torch import Tensor, nn
from torch.nn.functional import cross_entropy, one_hot

from motioncast.core.skeletons import UPPER9
from motioncast.core.upper_body import NECK, TRUNK_M
from motioncast.nn.pose_critic import PoseCritic, layers

UNIT_M = 0.1
"""Errors in the image are told in this unit, so that a usual one is about 1, as a cross entropy is."""


@dataclass(frozen=True)
class FutureHuman3DConfig:
    """Sizes of the model.

    Attributes:
        actions: Actions A that it knows.
        objects: Objects O that it knows; 0: it is told none.
        history: Past steps H.
        steps: Steps M that it answers.
        people: People P, 1 or 2.
        pooled: Whether two people see each other.
        preset: ``motioncast`` or ``paper`` (see the module).
        reads_poses: Whether past poses are seen.
        reads_actions: Whether past actions are.
        step_width: Features of a past step, before steps are joined; not of the preset ``paper``.
        pose_width: Features of the pose encoder.
        action_width: Of the action encoder.
        object_width: Of the object encoder.
        noise: Z.
        width: Of the common code.
        decoder_width: Of the decoders.
        action_weight: Weight of the cross entropy.
        pose_weight: Weight of the squared error in the image.
        critic_weight: Weight of the critic's score; 0: there is no critic.
    """

    actions: int = 14
    objects: int = 12
    history: int = 10
    steps: int = 10
    people: int = 1
    pooled: bool = True
    preset: Literal["motioncast", "paper"] = "motioncast"
    reads_poses: bool = True
    reads_actions: bool = True
    step_width: int = 64
    pose_width: int = 256
    action_width: int = 128
    object_width: int = 64
    noise: int = 16
    width: int = 512
    decoder_width: int = 256
    action_weight: float = 1.0
    pose_weight: float = 1.0
    critic_weight: float = 0.1


PRESETS = {
    "motioncast": FutureHuman3DConfig(),
    "paper": FutureHuman3DConfig(
        actions=37, objects=187, preset="paper", action_weight=1e6, pose_weight=1.0, critic_weight=1.0
    ),
}
"""Ours for the kitchen grammar, and the paper's for MPII Cooking II."""


class Past(NamedTuple):
    """What is known.

    Attributes:
        pixels: ``(B, H, P, J, 2)`` pixels, y down.
        seen: Which joints were seen, ``(B, H, P, J)`` bool; all False before the first step.
        actions: ``(B, H, P)`` int64; -1 before the first step.
        objects: Which there are, ``(B, O)`` float.
        camera: Focal length and centre of the image in pixels, ``(B, 3)``.
        depth: Of each person, ``(B, P)`` metres.
    """

    pixels: Tensor
    seen: Tensor
    actions: Tensor
    objects: Tensor
    camera: Tensor
    depth: Tensor


class Step(NamedTuple):
    """What is answered.

    Attributes:
        logits: Of each action, ``(B, P, A)``.
        poses: ``(B, P, J, 3)`` metres along the camera's axes, the neck at 0.
        pixels: The poses in the image, the neck where it was last seen, ``(B, P, J, 2)``.
    """

    logits: Tensor
    poses: Tensor
    pixels: Tensor


class ResidualBlock(nn.Module):
    """Two linear layers that are added to their input."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.change = layers(width, width, width)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, width)``, changed."""
        return features + self.change(features)


class Encoder(nn.Module):
    """One person's poses and actions, the objects and noise, to a common code (Sec. 3)."""

    def __init__(self, config: FutureHuman3DConfig) -> None:
        super().__init__()
        self.config = config
        wide, told = config.pose_width, 3 * len(UPPER9)
        self.step = (
            None if config.preset == "paper" else layers(told + config.actions, config.step_width, config.step_width)
        )
        entering = config.history * (told if self.step is None else config.step_width)
        self.poses = nn.Sequential(nn.Linear(entering, wide), *(ResidualBlock(wide) for _ in "123"))
        self.actions = layers(config.history * config.actions, config.action_width, config.action_width)
        self.objects = layers(max(config.objects, 1), config.object_width, config.object_width)
        joined = wide + config.action_width + config.object_width + config.noise
        self.join = layers(joined, config.width, config.width)

    def forward(self, offsets: Tensor, seen: Tensor, actions: Tensor, objects: Tensor, noise: Tensor) -> Tensor:
        """A code ``(B, width)`` of offsets ``(B, H, J, 2)`` and the rest."""
        config = self.config
        poses = torch.cat([offsets, seen[..., None].to(offsets.dtype)], -1).flatten(2)
        done = one_hot(actions + 1, config.actions + 1)[..., 1:].to(offsets.dtype)
        if not config.reads_poses:
            poses = torch.zeros_like(poses)
        if not config.reads_actions:
            done = torch.zeros_like(done)
        if not config.objects:
            objects = 0 * offsets[:, 0, 0, :1]
        steps = poses if self.step is None else self.step(torch.cat([poses, done], -1))
        codes = (self.poses(steps.flatten(1)), self.actions(done.flatten(1)), self.objects(objects))
        return self.join(torch.cat([*codes, noise], 1))


class Decoder(nn.Module):
    """The next action and the next pose of a code."""

    def __init__(self, config: FutureHuman3DConfig) -> None:
        super().__init__()
        narrow = config.decoder_width
        self.action = nn.Sequential(layers(config.width, narrow), nn.Linear(narrow, config.actions))
        self.pose = layers(config.width, narrow)
        self.place = nn.Linear(narrow, 3 * (len(UPPER9) - 1))

    def start_from(self, pose: Tensor) -> None:
        """Let an untrained decoder answer a pose ``(J, 3)``, such as the mean of the bank."""
        with torch.no_grad():
            self.place.bias.copy_(torch.cat([pose[:NECK], pose[NECK + 1 :]]).flatten())

    def forward(self, code: Tensor) -> tuple[Tensor, Tensor]:
        """Logits ``(B, A)`` and a pose ``(B, J, 3)`` whose neck is at 0."""
        others = self.place(self.pose(code)).unflatten(1, (-1, 3))
        neck = 0 * others[:, :1]  # zeros would be of a fixed number in the graph
        return self.action(code), torch.cat([others[:, :NECK], neck, others[:, NECK:]], 1)


class SocialPooling(nn.Module):
    """What a person is told of the other: the strongest features of the other's code and place (Social GAN)."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.place = nn.Linear(3, 64)
        self.pool = layers(64 + width, width, width)
        self.join = nn.Sequential(nn.Linear(2 * width, width), nn.LeakyReLU(0.2))

    def forward(self, codes: Tensor, places: Tensor) -> Tensor:
        """Codes ``(B, P, width)`` of people at ``(B, P, 3)`` metres, each knowing of the others."""
        joined = []
        for person in range(codes.shape[1]):
            others = [other for other in range(codes.shape[1]) if other != person]
            way = self.place(places[:, others] - places[:, person : person + 1])
            told = self.pool(torch.cat([way, codes[:, others]], -1)).amax(1)
            joined.append(self.join(torch.cat([codes[:, person], told], -1)))
        return torch.stack(joined, 1)


class FutureHuman3D(nn.Module):
    """The past of a video in; the next action and pose of each person out; with the critic that it learns from."""

    def __init__(self, config: FutureHuman3DConfig) -> None:
        super().__init__()
        self.config = config
        self.encoders = nn.ModuleList(Encoder(config) for _ in range(config.people))
        self.decoders = nn.ModuleList(Decoder(config) for _ in range(config.people))
        self.pooling = SocialPooling(config.width) if config.people > 1 and config.pooled else None
        self.critic = PoseCritic(UPPER9)

    def forward(self, past: Past, noise: Tensor) -> Step:
        """The next step, of noise ``(B, P, Z)``; zeros give the usual answer."""
        # a bf16 network would see joints some millimetres from where they are; it is small enough to do without
        with torch.autocast(past.pixels.device.type, enabled=False):
            return self.answer(past, noise)

    def answer(self, past: Past, noise: Tensor) -> Step:
        """As :meth:`forward`."""
        rays, scale = self.view(past)
        offsets = (past.pixels - past.pixels[..., NECK : NECK + 1, :]) * scale[:, None, :, None]
        offsets = torch.where(past.seen[..., None], offsets, 0.0)
        codes = []
        for person, encoder in enumerate(self.encoders):
            told = (offsets[:, :, person], past.seen[:, :, person], past.actions[:, :, person])
            codes.append(encoder(*told, past.objects, noise[:, person]))
        code = torch.stack(codes, 1)
        if self.pooling is not None:
            code = self.pooling(code, torch.cat([rays, torch.ones_like(rays[..., :1])], -1) * past.depth[..., None])
        answers = [decoder(code[:, person]) for person, decoder in enumerate(self.decoders)]
        logits, poses = (torch.stack(part, 1) for part in zip(*answers, strict=True))
        return self.in_image(past, poses, logits)

    def in_image(self, past: Past, poses: Tensor, logits: Tensor | None = None) -> Step:
        """Poses ``(B, P, J, 3)`` from the neck, and where they fall while the neck stays (Eq. 2)."""
        rays, scale = self.view(past)
        offsets = project(poses, rays, past.depth) / scale[:, :, None]
        necks = past.pixels[:, -1, :, NECK : NECK + 1]
        return Step(poses.new_zeros(0) if logits is None else logits, poses, necks + offsets)

    def view(self, past: Past) -> tuple[Tensor, Tensor]:
        """Slopes of the rays to the necks ``(B, P, 2)``, y up, and metres for a pixel right and down ``(B, P, 2)``."""
        focal, centre = past.camera[:, None, :1], past.camera[:, None, 1:]
        flip = past.camera.new_tensor([1.0, -1.0])
        rays = (past.pixels[:, -1, :, NECK] - centre) / focal * flip
        return rays, past.depth[..., None] / focal * flip

    def loss(self, past: Past, noise: Tensor, actions: Tensor, pixels: Tensor, seen: Tensor) -> Tensor:
        """What the generator lowers: L = L_action + L_2d + L_adv, weighted (Eq. 1-3).

        Args:
            past: What is known.
            noise: ``(B, P, Z)``.
            actions: What came next, ``(B, P)``.
            pixels: In which pose, ``(B, P, J, 2)``.
            seen: Which of its joints were seen, ``(B, P, J)``.
        """
        step = self(past, noise)
        loss = self.config.action_weight * cross_entropy(step.logits.flatten(0, 1), actions.flatten())
        return loss + self.pose_loss(step, past, pixels, seen)

    def pose_loss(self, step: Step, past: Past, pixels: Tensor, seen: Tensor) -> Tensor:
        """L_2d + L_adv of an answer, weighted."""
        config = self.config
        loss = config.pose_weight * self.image_error(step, past, pixels, seen)
        if config.critic_weight:
            loss = loss - config.critic_weight * self.critic(step.poses.flatten(0, 1)).mean()
        return loss

    def image_error(self, step: Step, past: Past, pixels: Tensor, seen: Tensor) -> Tensor:
        """Mean squared distance in the image of joints that are seen, from the neck (Eq. 3)."""
        error = step.pixels - step.pixels[:, :, NECK : NECK + 1] - (pixels - pixels[:, :, NECK : NECK + 1])
        if self.config.preset != "paper":
            error = error * self.view(past)[1][:, :, None] / UNIT_M
        both = seen & seen[..., NECK : NECK + 1]
        return error.square().sum(-1)[both].mean()

    def made(self, past: Past, noise: Tensor, pixels: Tensor, seen: Tensor) -> Tensor:
        """The poses ``(B * P, J, 3)`` that the critic is to see through; arguments as of :meth:`loss`."""
        return self(past, noise).poses.flatten(0, 1)

    def append(self, past: Past, step: Step) -> Past:
        """The past after an answer: its most likely action and its pose in the image are the last step."""
        likely = step.logits.argmax(-1)[:, None]
        return past._replace(
            pixels=torch.cat([past.pixels[:, 1:], step.pixels[:, None]], 1),
            seen=torch.cat([past.seen[:, 1:], torch.ones_like(past.seen[:, :1])], 1),
            actions=torch.cat([past.actions[:, 1:], likely], 1),
        )

    def start_from(self, pose: Tensor) -> None:
        """Let the untrained model answer a pose ``(J, 3)``, such as the mean of the bank."""
        for decoder in self.decoders:
            assert isinstance(decoder, Decoder)
            decoder.start_from(pose)

    def silence(self, past: Past) -> Tensor:
        """Noise of zeros for the usual answer."""
        return past.depth.new_zeros((*past.depth.shape, self.config.noise))


def project(poses: Tensor, rays: Tensor, depth: Tensor) -> Tensor:
    """Where joints fall in the image from the neck, in metres at its depth (Eq. 2).

    Args:
        poses: ``(B, P, J, 3)`` metres along the camera's axes, the neck at 0.
        rays: Slopes of the rays to the necks, ``(B, P, 2)``.
        depth: Of the necks, ``(B, P)`` metres.
    """
    away = depth[..., None, None] - poses[..., 2:]
    # an untrained pose may lie behind the camera, where a projection means nothing
    away = away.clamp(min=0.1 * TRUNK_M)
    slopes = (poses[..., :2] + rays[:, :, None] * depth[..., None, None]) / away
    return (slopes - rays[:, :, None]) * depth[..., None, None]


MODEL, CONFIG = FutureHuman3D, FutureHuman3DConfig
