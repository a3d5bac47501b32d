"""The benchmark of the kitchen grammar: ten steps in, ten steps out, every step an action and a pose."""
