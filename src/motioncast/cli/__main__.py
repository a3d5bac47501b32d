"""``python -m motioncast.cli``: the command where its script is not on the path."""

from motioncast.cli import main

main()
