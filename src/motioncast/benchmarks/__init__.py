"""Protocols, the runner and what it prints."""
