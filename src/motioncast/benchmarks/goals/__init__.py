"""The benchmark of characteristic poses (``cmu-goals``): its questions, simple guesses, and figures."""
