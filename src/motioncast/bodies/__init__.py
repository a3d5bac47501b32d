"""Bodies: from joints to a surface."""
