"""One file a format: motion files in, scenes out, and back."""
