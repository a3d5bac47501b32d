"""One file a system, in torch, readable like the method section of its paper."""
