#!/usr/bin/python3
"""report_schema.py PROGRAM FOLDER [--slow]: every command's report.json holds to the JSON Schema that the program prints,
and what does not is refused by it. --slow: of the commands that take longest, else of the others."""
import copy
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import jsonschema

PROGRAM, FOLDER = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2])
CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name

BALL = """
phantom = { name = "sphere", voxel_mm = 2 }
acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }
render.scan_conversion.slice_size = 64
render.ray_casting.image_size = 64
render.ray_casting.steps = 64
"""
PLAN = f"""design = "sobol"
points = 2
seeds = 1
repeats = 1
[scenes.ball]{BALL}[unseen.ball]{BALL}[axes]
"render.ray_casting.steps" = [32, 64]
"""
POPULATION = """seed = 4
scenes = 2
scene = { phantom = { name = "sphere", voxel_mm = 2 }, render = { ray_casting = { image_size = 64, steps = 64 } } }
"""
QUICK = {
    "run": "ball.toml --register --count-work --limit p95_mm<=9 --out run",
    "score": "run/depth.exr --scene run/report.json --out score",
    "compare": f"run {PROGRAM} --scene ball.toml --out compare",
    "stream": "ball.toml --volumes 3 --limit age_newest_p50_ms<=60000 --out stream",
    "record": "ball.toml --volumes 2 --out record",
    "inspect": "record/recording.wbst",
    "conformance": "ball.toml --out conformance",
    "rehearse": "--seeds 5 --out rehearse",
    "phantom": "--set phantom.voxel_mm=2 --out phantom",
    "accuracy": "ball.toml --seeds 2 --out accuracy",
    "trade": "plan.toml --out trade",
    "tune": "plan.toml --limit p95_mm<=20 --evaluations 2 --random --out tune",
    "dataset": "population.toml --out dataset",
    "tables": "--divisor 8 --repeats 1 --out tables",
    "latency": "ball.toml --volumes 10 --out latency",
}
SLOW = {
    "rungs": "--set phantom.voxel_mm=2 --repeats 1 --out rungs",
    "fit": "ball.toml --seeds 1 --coverage 1 --out fit",
    "board": "--repeats 1 --out board",
    "extremes": "--out extremes",
}
NO_REPORT = {"live", "export", "stand-in"}


def output(*words):
    done = subprocess.run([PROGRAM, *words], cwd=FOLDER, capture_output=True, text=True)
    # `tune` may say that a limit is broken, which it is not asked about here.
    assert done.returncode in (0, 1) and done.stdout, (words, done.returncode, done.stderr)
    return json.loads(done.stdout)


def errors_of(validator, report):
    return [f"{error.json_path}: {error.message[:300]}" for error in validator.iter_errors(report)]


def expect_refused(validator, report, change):
    changed = copy.deepcopy(report)
    change(changed)
    assert errors_of(validator, changed), "the schema allows a report that is wrong"


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    for name, text in (("ball", BALL), ("plan", PLAN), ("population", POPULATION)):
        (FOLDER / f"{name}.toml").write_text(text)
    schema = output("--report-schema")
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    assert set(schema["properties"]["command"]["enum"]) == {*QUICK, *SLOW} | NO_REPORT
    reports = {}
    for command, words in (SLOW if "--slow" in sys.argv else QUICK).items():
        reports[command] = output(command, *words.split(), "--json")
        assert reports[command]["command"] == command
        wrong = errors_of(validator, reports[command])
        assert not wrong, (command, wrong)
    if "run" not in reports:
        return
    run, stream = reports["run"], reports["stream"]
    expect_refused(validator, run, lambda report: report.update(schema=1))
    expect_refused(validator, run, lambda report: report.pop("checks"))
    expect_refused(validator, run, lambda report: report["checks"][0].pop("held"))
    expect_refused(validator, run, lambda report: report["error"].pop("p95_mm"))
    expect_refused(validator, run, lambda report: report["error"].update(p95_mm="1.4"))
    expect_refused(validator, run, lambda report: report["error"]["regions"][0].update(rms_mm={"mean": 1}))
    expect_refused(validator, stream, lambda report: report["timing"]["latency"].pop("age_newest_p99_ms"))
    expect_refused(validator, reports["accuracy"],
                   lambda report: report["accuracy"]["summaries"][0]["means"].update(p95_mm=["1"]))


main()
