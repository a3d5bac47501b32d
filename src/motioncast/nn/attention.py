"""A transformer encoder layer whose attention can be read."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional


class EncoderLayer(nn.Module):
    """Self-attention and a feed-forward net, each with a residual.

    Args:
        width: Channels of a token.
        heads: Attention heads.
        feed_forward: Hidden channels of the feed-forward net.
        dropout: Share of dropped channels in training.
        norm_first: Normalise before each part (pre-norm, GELU) instead of after it (post-norm, ReLU).
    """

    def __init__(self, width: int, heads: int, feed_forward: int, dropout: float, *, norm_first: bool = False) -> None:
        super().__init__()
        self.width, self.heads, self.norm_first, self.dropout = width, heads, norm_first, dropout
        self.project = nn.Linear(width, 3 * width)
        self.merge = nn.Linear(width, width)
        self.rise = nn.Linear(width, feed_forward)
        self.fall = nn.Linear(feed_forward, width)
        self.norm_attention = nn.LayerNorm(width)
        self.norm_feed = nn.LayerNorm(width)
        self.drop = nn.Dropout(dropout)

    def forward(
        self, tokens: Tensor, bias: Tensor, weights: list[Tensor] | None = None, first: int | None = None
    ) -> Tensor:
        """Updated tokens.

        Args:
            tokens: ``(batch, tokens, width)``.
            bias: Added to the attention scores, broadcastable to ``(batch, heads, tokens, tokens)``.
            weights: If given, the attention weights ``(batch, heads, tokens, tokens)`` are appended to it.
            first: Update and return only so many first tokens, where nobody reads the others.
        """
        count = tokens.shape[1] if first is None else first
        kept = self.rows(tokens[:, :first])
        if self.norm_first:
            kept = kept + self.drop(self.attend(self.norm_attention(tokens), bias, weights, first))
            kept = kept + self.drop(self.fall(self.drop(functional.gelu(self.rise(self.norm_feed(kept))))))
        else:
            kept = self.norm_attention(kept + self.drop(self.attend(tokens, bias, weights, first)))
            kept = self.norm_feed(kept + self.drop(self.fall(self.drop(torch.relu(self.rise(kept))))))
        return kept.view(-1, count, self.width)

    def rows(self, tokens: Tensor) -> Tensor:
        """Tokens of the whole batch as rows of one matrix: in a graph a product and its bias are then one step."""
        return tokens.reshape(-1, self.width)

    def attend(self, tokens: Tensor, bias: Tensor, weights: list[Tensor] | None, first: int | None) -> Tensor:
        """Multi-head self-attention of the first tokens, as rows."""
        each = self.width // self.heads
        project = zip(self.project.weight.split(self.width), self.project.bias.split(self.width), strict=True)
        query, key, value = (
            functional.linear(self.rows(read), *part).view(-1, read.shape[1], self.heads, each).transpose(1, 2)
            for read, part in zip((tokens[:, :first], tokens, tokens), project, strict=True)
        )
        if weights is None:
            mixed = functional.scaled_dot_product_attention(
                query, key, value, attn_mask=bias, dropout_p=self.dropout if self.training else 0.0, scale=each**-0.5
            )
        else:
            scores = query @ key.transpose(-1, -2) * each**-0.5 + bias
            weights.append(scores.softmax(-1))
            mixed = weights[-1] @ value
        return self.merge(self.rows(mixed.transpose(1, 2)))
