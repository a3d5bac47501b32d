"""One file a data set: official layout in, scenes out; splits, windows and composed scenes."""
