"""The nouns (skeleton, scene, forecast, card) and their maths; NumPy only."""
