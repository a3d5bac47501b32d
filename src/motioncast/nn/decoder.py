"""A transformer decoder layer whose memory may be one for all tokens or another for each."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional


class DecoderLayer(nn.Module):
    """Self-attention, attention to a memory and a feed-forward net, each with a residual.

    Args:
        width: Channels of a token.
        heads: Attention heads.
        feed_forward: Hidden channels of the feed-forward net.
        dropout: Share of dropped channels in training.
        norm_first: Normalise before each part (pre-norm, GELU) instead of after it (post-norm, ReLU).
    """

    def __init__(self, width: int, heads: int, feed_forward: int, dropout: float, *, norm_first: bool = False) -> None:
        super().__init__()
        self.heads, self.norm_first = heads, norm_first
        self.project = nn.Linear(width, 3 * width)
        self.merge = nn.Linear(width, width)
        self.ask = nn.Linear(width, width)
        self.look = nn.Linear(width, 2 * width)
        self.merge_memory = nn.Linear(width, width)
        self.rise = nn.Linear(width, feed_forward)
        self.fall = nn.Linear(feed_forward, width)
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(3))
        self.drop = nn.Dropout(dropout)

    def forward(
        self, tokens: Tensor, seen: Tensor, memory: Tensor, bias: Tensor | None, placed: Tensor | None = None
    ) -> Tensor:
        """Updated tokens ``(N, T, width)``.

        Args:
            tokens: ``(N, T, width)``.
            seen: Added to the scores among tokens, ``(T, T)``.
            memory: For all tokens, ``(N, K, width)``, or for each, ``(N, T, K, width)``.
            bias: Added to the scores of the memory, ``(N, 1, 1 or T, K)`` or ``(N, 1, 1, 1, K)``.
            placed: If given, the memory is ``(B, T, K, width)``, shared by the Q readers of each of B scenes, and this,
                ``(B, Q, T, K, 2 width)``, is added to its keys and values; N is then ``B Q``.
        """
        pairs = self.look(memory)
        if placed is not None:
            pairs = (pairs[:, None] + placed).flatten(0, 1)
        parts = (
            lambda tokens: self.among(tokens, seen),
            lambda tokens: self.read(tokens, pairs, bias),
            self.feed,
        )
        for part, norm in zip(parts, self.norms, strict=True):
            if self.norm_first:
                tokens = tokens + self.drop(part(norm(tokens)))
            else:
                tokens = norm(tokens + self.drop(part(tokens)))
        return tokens

    def among(self, tokens: Tensor, seen: Tensor) -> Tensor:
        """Self-attention."""
        query, key, value = self.project(tokens).chunk(3, -1)
        return self.merge(self.attend(query, key, value, seen))

    def read(self, tokens: Tensor, pairs: Tensor, bias: Tensor | None) -> Tensor:
        """Attention to the keys and values of the memory."""
        query, (key, value) = self.ask(tokens), pairs.chunk(2, -1)
        if pairs.dim() == 3:
            return self.merge_memory(self.attend(query, key, value, bias))
        return self.merge_memory(self.attend(query[:, :, None], key, value, bias)[:, :, 0])

    def feed(self, tokens: Tensor) -> Tensor:
        """The feed-forward net."""
        risen = self.rise(tokens)
        return self.fall(self.drop(functional.gelu(risen) if self.norm_first else torch.relu(risen)))

    def attend(self, query: Tensor, key: Tensor, value: Tensor, bias: Tensor | None) -> Tensor:
        """What each query ``(..., Q, width)`` gathers from values ``(..., K, width)``, with heads apart."""
        query, key, value = (part.unflatten(-1, (self.heads, -1)).transpose(-2, -3) for part in (query, key, value))
        scores = query @ key.transpose(-1, -2) * query.shape[-1] ** -0.5
        weights = (scores if bias is None else scores + bias).softmax(-1).to(value.dtype)
        return (functional.dropout(weights, self.drop.p, self.training) @ value).transpose(-2, -3).flatten(-2)
