"""Numbers that are the same bits on every processor: linear algebra and elementary functions."""
