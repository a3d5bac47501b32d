"""The contract suite: checks that every model, shipped or yours, must hold."""
