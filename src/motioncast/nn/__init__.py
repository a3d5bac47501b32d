"""Torch bricks that two or more models share."""
