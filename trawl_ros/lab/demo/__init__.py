"""`trawl demo`: the whole chain, towed, recorded, replayed, refitted and diagnosed."""
