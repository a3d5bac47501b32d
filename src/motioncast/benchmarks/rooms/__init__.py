"""The benchmark of furnished rooms: one second in, ten seconds out, people who come and go."""
