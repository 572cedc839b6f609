"""A test bench for 4D ultrasound rendering: scenes, simulated and recorded volumes, the renderer, truth and score.

Lengths are in metres where a name ends in _m; keys of scenes and scores carry their units. docs/python.md has examples.
"""

from ._wobblebench import *  # noqa: F403
from ._wobblebench import __version__  # noqa: F401
