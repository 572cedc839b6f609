"""A test bench for 4D ultrasound rendering: scenes, simulated and recorded volumes, the renderer, truth and score.

Lengths are in metres where a name ends in _m; keys of scenes and scores carry their units. docs/python.md has examples.
"""

try:
    from ._wobblebench import *  # noqa: F403
    from ._wobblebench import __version__  # noqa: F401
except ModuleNotFoundError as error:
    import pathlib as _pathlib
    import sys as _sys
    _built = ", ".join(file.name for file in _pathlib.Path(__file__).parent.glob("_wobblebench.*")) or "no module"
    raise ImportError(f"wobblebench: {_built} is here, which {_sys.implementation.cache_tag} does not load: "
                      "run the Python that it was built for, or build it with this one") from error
