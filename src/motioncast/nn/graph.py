"""A graph network whose edges are learned: that of LTD and, after it, of HisRep.

Paper: Mao, Liu, Salzmann, Li, "Learning Trajectory Dependencies for Human Motion Prediction", 2019, Sec. 3.2-3.3.
A node is one coordinate of one joint; every node is joined to every other by a learned weight, of either sign.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

UNIT_M = 0.1
"""The network answers in decimetres. The papers' millimetres learn a person's path slowly, and metres begin far off;
what goes in may have any unit, since the first layer normalises it."""


class GraphConvolution(nn.Module):
    """``A X W + b``: features of each node, mixed over all nodes.

    Args:
        nodes: Nodes of the graph.
        inward: Features of a node.
        outward: Features of a node afterwards.
    """

    def __init__(self, nodes: int, inward: int, outward: int) -> None:
        super().__init__()
        self.adjacency = nn.Parameter(torch.empty(nodes, nodes))
        self.linear = nn.Linear(inward, outward)
        for parameter in self.parameters():
            nn.init.uniform_(parameter, -(outward**-0.5), outward**-0.5)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, nodes, inward)`` to ``(N, nodes, outward)``."""
        return self.linear(torch.bmm(self.adjacency.expand(features.shape[0], -1, -1), features))


class GraphLayer(nn.Module):
    """A graph convolution, batch normalisation of each feature of each node, tanh and dropout."""

    def __init__(self, nodes: int, inward: int, outward: int, dropout: float) -> None:
        super().__init__()
        self.convolution = GraphConvolution(nodes, inward, outward)
        self.norm = nn.BatchNorm1d(nodes * outward)
        self.drop = nn.Dropout(dropout)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, nodes, inward)`` to ``(N, nodes, outward)``."""
        mixed = self.convolution(features)
        return self.drop(torch.tanh(self.norm(mixed.flatten(1)).view_as(mixed)))


class GraphNetwork(nn.Module):
    """A layer in, residual blocks of two layers each, a convolution out, and the input added to the result.

    Args:
        nodes: Nodes of the graph.
        features: Features of a node, in and out.
        width: Features of a node within.
        blocks: Residual blocks.
        dropout: Share of dropped features in training.

    Example:
        >>> network = GraphNetwork(45, 60, 256, 12, 0.5)
        >>> sum(parameter.numel() for parameter in network.parameters())
        2238694
    """

    def __init__(self, nodes: int, features: int, width: int, blocks: int, dropout: float) -> None:
        super().__init__()
        self.rise = GraphLayer(nodes, features, width, dropout)
        self.blocks = nn.ModuleList(
            nn.Sequential(GraphLayer(nodes, width, width, dropout), GraphLayer(nodes, width, width, dropout))
            for _ in range(blocks)
        )
        self.fall = GraphConvolution(nodes, width, features)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, nodes, features)``, changed."""
        hidden = self.rise(features)
        for block in self.blocks:
            hidden = hidden + block(hidden)
        return features + UNIT_M * self.fall(hidden)
