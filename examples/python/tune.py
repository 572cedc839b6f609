#!/usr/bin/env python3
"""Tune three settings of the renderer by Optuna, on one volume, for a small error of depth.

    tune.py docs/scenes/sphere.toml --trials 40
"""
import argparse

import optuna

import wobblebench

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", default="", help="TOML file; default: the face of a fetus")
parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE")
parser.add_argument("--trials", type=int, default=40)
arguments = parser.parse_args()

scene = wobblebench.Scene(arguments.scene, arguments.set)
volume = wobblebench.simulate(scene)
renderer = wobblebench.Renderer(scene)


# What is tuned: keys, their ranges, and the scene's own values, with which the search begins: it ends with no worse.
RANGES = {"render.ray_casting.below_tissue_db": (3, 12), "render.reconstruction.spacing_mm": (0.5, 4),
          "render.ray_casting.outline_mm": (0, 6)}
render = scene.options["render"]
own = {key: render[key.split(".")[1]][key.split(".")[2]] for key in RANGES}


def settings_of(trial):
    return {key: trial.suggest_float(key, *ends) for key, ends in RANGES.items()}


def loss_of(tuned):
    """P95 in mm, and half a millimetre for each percent of the picture that is missed or false."""
    figures = wobblebench.score(renderer.render(volume, tuned), tuned)
    if figures["p95_mm"] is None:
        return 100.0
    return figures["p95_mm"] + 0.5 * (figures["missed_percent"] + figures["false_percent"])


optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
study.enqueue_trial(own)
study.optimize(lambda trial: loss_of(scene.replace(settings_of(trial))), n_trials=arguments.trials)
print(f"{loss_of(scene):.3f} by the scene's own settings")
print(f"{study.best_value:.3f} with " + ", ".join(f"{key} {value:.4g}" for key, value in study.best_params.items()))
