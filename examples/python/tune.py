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


def settings_of(trial):
    return {
        "render.ray_casting.detector": "paper",
        "render.ray_casting.threshold": trial.suggest_float("threshold", 0.02, 0.5, log=True),
        "render.ray_casting.buffer_length": trial.suggest_int("n", 2, 16, step=2),
        "render.ray_casting.steps": trial.suggest_int("steps", 100, 400, step=50),
    }


def loss_of(tuned):
    """P95 in mm, and half a millimetre for each percent of the picture that is missed or false."""
    figures = wobblebench.score(renderer.render(volume, tuned), tuned)
    if figures["p95_mm"] is None:
        return 100.0
    return figures["p95_mm"] + 0.5 * (figures["missed_percent"] + figures["false_percent"])


optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
study.optimize(lambda trial: loss_of(scene.replace(settings_of(trial))), n_trials=arguments.trials)
print(f"{loss_of(scene):.3f} by the scene's own settings")
print(f"{study.best_value:.3f} with " + ", ".join(f"{name} {value:.4g}" for name, value in study.best_params.items()))
