"""Effects of the water: currents, leeway, sea and ground."""
