"""Digits of the orbits in the proof that the twisted top is chaotic, from a search that shares no code with it."""

START = (
    "-0.5849546905925892238328821", "0", "0.8032794505793064473190131",
    "-0.0918280646269358374982886", "0", "1.032194387546707320580467",
    "0.8296944816464005507471012", "0", "0.5582177595934320501343493",
)  # fmt: skip
"""The start of the periodic orbit, in Fix rho2; l3 and alpha3 of one of its two images under R1."""

QUARTER = "1.593567767852104997"
"""The time from there to Fix rho3."""

MIDPOINT = (
    "0.6203706904787318041726", "-0.4414426667392547903323", "0",
    "-0.3550671445942691932176", "1.481878534758992432401", "0",
    "-0.9950894158600804697264", "0.09898007093977974773725", "0",
)  # fmt: skip
"""The midpoint of the homoclinic orbit, in Fix rho3, one of its images under R1."""
