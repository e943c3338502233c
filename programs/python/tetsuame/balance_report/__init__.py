"""Pictures of a run of `balance`: the cuts and the ranks' times, and their course."""
