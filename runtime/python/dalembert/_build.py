"""The generator as a program: what is asked of it, and what it says."""

import difflib
import functools
import json
import math
import numbers
import os
import pathlib
import subprocess
from typing import NamedTuple

from ._place import EXECUTABLE

OPTIONS = ("scene", "name", "form", "compiler", "flags", "lanes")


class InputError(ValueError):
    """The URDF, the scene or a keyword is wrong; the message names the element and says what to do."""


class SelfTestError(RuntimeError):
    """The compiled code computes on this machine something else than it should."""


class CheckResult(NamedTuple):
    passed: bool
    text: str


@functools.cache
def _registry():
    with open(pathlib.Path(__file__).with_name("registry.json"), encoding="utf-8") as file:
        return json.load(file)


def quantities():
    """The quantities there are, by name: {name: {symbol, function, takes, unit, by_default, help}}."""
    return {row["name"]: {k: v for k, v in row.items() if k != "name"} for row in _registry()["quantities"]}


def link_quantities():
    """What can be asked of a link in `frames`, by name: {name: {unit, by_default, help}}."""
    return {row["name"]: {k: v for k, v in row.items() if k != "name"} for row in _registry()["link_quantities"]}


def scene_keys():
    """The keywords of load() that are keys of a scene (docs/scene.md)."""
    return list(_registry()["scene_keys"])


def in_our_names(name):
    """What a quantity is called here: the name itself, where it is none of the field's for it."""
    return _registry()["aliases"].get(name, name) if isinstance(name, str) else name


def did_you_mean(name, names):
    """"; did you mean 'mass_matrix'?" where one of the names is close, else what there is."""
    near = difflib.get_close_matches(str(name), names, 1, 0.6)
    if near:
        return f"; did you mean '{near[0]}'?"
    return f"; there are {', '.join(names)}" if names else ""


def executable():
    """The generator: $DALEMBERT_EXECUTABLE, or the one this package was built or installed with."""
    path = os.environ.get("DALEMBERT_EXECUTABLE") or os.path.normpath(os.path.join(os.path.dirname(__file__), EXECUTABLE))
    if not os.access(path, os.X_OK):
        raise FileNotFoundError(f"there is no generator at {path}: build it, or name it with DALEMBERT_EXECUTABLE")
    return path


def _plain(value):
    """A value of a scene as JSON has it: numpy's numbers and arrays, tuples, sets and None become its own."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        return float(value)
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, (set, frozenset)):
        return sorted(_plain(v) for v in value)
    if hasattr(value, "__iter__"):
        return [_plain(v) for v in value]
    raise InputError(f"a value of type {type(value).__name__} cannot stand in a scene")


def setting(key, value):
    """The text of a keyword, as the command line has it."""
    if key == "scalar" and not isinstance(value, str):
        import numpy
        value = {"float64": "double", "float32": "float"}.get(numpy.dtype(value).name, str(value))
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    return _yaml(_plain(value))


def _yaml(value):
    """A plain value as YAML has it in one line: JSON, but for the numbers that are none."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k, ensure_ascii=False)}: {_yaml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return json.dumps(value, ensure_ascii=False)


def own(keywords):
    """The keywords of load() as they are now, whatever becomes of the caller's lists, arrays and generators."""
    names = scene_keys()
    return {k: _plain(v) if k in names and k != "scalar" else
            list(v) if k == "flags" and v is not None and not isinstance(v, str) and hasattr(v, "__iter__") else v for k, v in keywords.items()}


def arguments(urdf, keywords):
    """The words of a command line for a robot and the keywords of load()."""
    names = scene_keys()
    words = [os.fsdecode(urdf)]
    if words[0].startswith("-"):
        words[0] = "./" + words[0]
    for key, value in keywords.items():
        if key in OPTIONS:
            if value is not None:
                if key == "flags" and not isinstance(value, str):
                    if not hasattr(value, "__iter__"):
                        raise TypeError(f"load(): flags are of type {type(value).__name__}, expected one string or a list of them")
                    if any(" " in flag for flag in value):
                        raise ValueError("load(): a flag with a blank in it cannot be handed on; give flags without")
                    value = " ".join(value)
                if value != "":
                    words.append(f"--{key}={os.fspath(value) if key == 'scene' else value}")
        elif key in names and (value is None and key != "gravity" or value is False and key == "batch"):
            continue  # not given; whether a robot's batches are used makes no other code
        elif key in names:
            words.append(f"--{key}={setting(key, value)}")
        else:
            raise TypeError(f"load() has no keyword '{key}'" + did_you_mean(key, names + list(OPTIONS)))
    outputs = keywords.get("outputs")
    if outputs is not None:
        if not hasattr(outputs, "__iter__"):
            raise TypeError(f"load(): outputs are of type {type(outputs).__name__}, expected a list of names, or one string of them")
        known = [*(row["name"] for row in _registry()["quantities"]), *_registry()["aliases"]]
        if isinstance(outputs, str) and "{" in outputs:
            outputs = []  # parts of results, in YAML: the generator looks names up
        for name in outputs.strip("[]").split(",") if isinstance(outputs, str) else names_of(outputs):
            if str(name).strip() and str(name).strip() not in known:
                raise KeyError(f"there is no quantity '{name}'" + did_you_mean(name, known))
    return words


def names_of(outputs):
    """Of a list of outputs, some of which are maps from a quantity to a part of it."""
    for item in [outputs] if isinstance(outputs, dict) else outputs:
        yield from item if isinstance(item, dict) else [item]


def run(command, words, accept=(0,)):
    """Runs the generator. Returns its exit status and what it printed; raises InputError with what it said otherwise."""
    result = subprocess.run([executable(), command, *words], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                            errors="replace")
    if result.returncode in accept:
        return result.returncode, result.stdout
    said = result.stderr.strip() or f"{command} ended with status {result.returncode}"
    if result.returncode == 1:
        raise SelfTestError(said)
    if result.returncode == 2:
        raise InputError(said.replace("option --", "keyword "))
    raise RuntimeError(said)


def info(urdf, *, text=False, **keywords):
    """The robot as the compiler sees it: joints, quantities with their operations, ways to compute them; as a page if `text`."""
    _, printed = run("info", arguments(urdf, keywords) + ([] if text else ["--json"]))
    return printed if text else json.loads(printed)


def check(urdf, **keywords):
    """Compares generated code with the generic engine and with 50 digits, and times it: (passed, text)."""
    status, printed = run("check", arguments(urdf, keywords), accept=(0, 1))
    return CheckResult(status == 0, printed)


def report(urdf, folder, *, quick=False, **keywords):
    """Writes folder/report.csv and folder/index.html: error against time, extreme cases, forms. Returns (passed, text)."""
    words = arguments(urdf, keywords) + ["--out", os.fspath(folder)] + (["--quick"] if quick else [])
    status, printed = run("report", words, accept=(0, 1))
    return CheckResult(status == 0, printed)


def clear_cache():
    """Removes what load() has compiled and kept, as `dalembert cache --clear` does. What is loaded stays loaded."""
    return run("cache", ["--clear"])[1].strip()
