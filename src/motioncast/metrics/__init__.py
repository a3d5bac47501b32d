"""Errors and other measures: pure functions with masks, one file a family."""
