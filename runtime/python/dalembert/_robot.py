"""load() and what it returns."""

import collections
import functools
import hashlib
import inspect
import json
import keyword
import math
import numbers
import os
import pathlib
import threading
import warnings
from typing import NamedTuple

import numpy

from . import _build, _core


class InputWarning(UserWarning):
    """What the compiler passed over in the URDF or the scene, by name."""


def _in_a_row(parts):
    return numpy.concatenate([numpy.ravel(part).astype(float) for part in parts])


def _members(value, **counts):
    """The numbers of a Payload, Contact or Loop one after another. counts: of members that have several, how many; a member of
    rows may have six, whose last ones are left out. ValueError for a member that has others."""
    parts = []
    for name, part in zip(value._fields, value):
        wanted, part = counts.get(name, 1), numpy.ravel(part)
        if len(part) == 6 and name in ("regularization", "weight"):
            part = part[:wanted]
        if len(part) != wanted:
            raise ValueError(f"{name} of {type(value).__name__} has {len(part)} number{'s' * (len(part) != 1)}, expected {wanted}")
        if part.dtype.kind not in "biuf":
            raise ValueError(f"{name} of {type(value).__name__} is {part.tolist()}, expected numbers")
        parts.append(part.astype(float))
    return numpy.concatenate(parts)


class Payload(NamedTuple):
    """A rigid body that a link carries, given at run time (scene key `payloads`)."""

    mass: float = 0.0  # kg
    com: tuple = (0.0, 0.0, 0.0)  # centre of mass, m, in the link's frame
    inertia: tuple = (0.0,) * 6  # xx xy xz yy yz zz about the centre of mass, kg m², the link's axes

    def numbers(self, size):
        """As run-time inputs have them, one after another."""
        return _members(self, com=3, inertia=6)


class Contact(NamedTuple):
    """How a contact acts, given at run time (scene key `contacts`): its rows' accelerations shall be -kd J v - kp e."""

    active: bool = True  # else it exerts nothing
    kp: float = 0.0  # 1/s²
    kd: float = 0.0  # 1/s
    restitution: float = 0.0  # of an impact: J v becomes -restitution J v
    anchor: tuple = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)  # place in the world, m, and quaternion x y z w; matters where kp does
    regularization: tuple = (0.0,) * 6  # added to the diagonal of J M⁻¹ Jᵀ, per row; of a point the first three
    weight: tuple = (1.0,) * 6  # likewise, of the row's force in constrained_inverse_dynamics

    def numbers(self, size):
        """As run-time inputs have them, one after another: of all rows together `size`."""
        rows = max(0, (size - 11) // 2)  # less: another's place, and refused there
        return _members(self, anchor=7, regularization=rows, weight=rows)


class Loop(NamedTuple):
    """How a loop acts, given at run time (scene key `loops`): its rows' accelerations shall be -kd J v - kp e."""

    active: bool = True  # else it exerts nothing
    kp: float = 0.0  # 1/s²
    kd: float = 0.0  # 1/s
    restitution: float = 0.0  # of an impact: J v becomes -restitution J v
    regularization: tuple = (0.0,) * 6  # added to the diagonal of J M⁻¹ Jᵀ, per row; of a hinge the first five, and so on
    weight: tuple = (1.0,) * 6  # likewise, of the row's force in constrained_inverse_dynamics

    def numbers(self, size):
        """As run-time inputs have them, one after another: of all rows together `size`."""
        rows = max(0, (size - 4) // 2)
        return _members(self, regularization=rows, weight=rows)


class LinkageStatus(NamedTuple):
    """What closing embedded loops came to (scene key `loops` with `independent`), of one state or, as arrays, of n."""

    error: float  # the largest that is left, m or rad
    least_pivot: float  # near zero where there is a toggle point
    linkage: int  # the first at a toggle point, from 0, or -1


def load(urdf, **keywords):
    """The robot's functions, generated and compiled, or found in the cache.

    urdf: the file's name. Keywords: `scene`, a YAML file; the scene's keys (docs/scene.md), which override it: base, gravity,
    outputs, functions, frames, locked, ...; and compiler, flags (one string, or a list of them), form, lanes, name, as of
    `dalembert generate` and `check`. None stands for a keyword that is not given, but for gravity, of which it leaves none.
    batch: True compiles the functions' batches now, False never, one state then being computed after another; without, a function's
    batch is compiled when it is called for n states first.
    Raises InputError (a ValueError) where the input is wrong, KeyError for a quantity that there is not, TypeError for an unknown
    keyword, SelfTestError where the compiled code does not compute what it should. Whoever else loads the same at the same time
    waits; the code is compiled once.
    """
    keywords = _build.own(keywords)
    for _ in range(3):  # somebody may clear the cache in between
        folder = pathlib.Path(_build.run("build", _build.arguments(urdf, keywords))[1].rstrip("\n"))
        try:
            return Robot._of_entry(folder, urdf, keywords)
        except FileNotFoundError:
            continue
    raise RuntimeError(f"{folder} does not stay as it is made")


@functools.lru_cache(maxsize=None)
def _results_type(name, fields):
    made = collections.namedtuple(name + "_" * keyword.iskeyword(name), fields, module=__name__)
    made.__reduce__ = lambda self: (_results, (name, fields, tuple(self)))
    return made


def _results(name, fields, values):
    """Pickled results: their type has a name of the scene's."""
    return _results_type(name, fields)(*values)


class _Batches:
    """The batches of a robot's functions, in libraries of their own, compiled where somebody asks for them first."""

    def __init__(self, folder, urdf, keywords):
        self._folder, self._urdf, self._keywords = folder, urdf, keywords
        self._libraries, self._lock = {}, threading.Lock()

    def prepare(self, parts):
        """Compiles what there is not yet of the parts."""
        if parts and not all((self._folder / f"batches_{part}.json").exists() for part in parts):
            _build.run("build-batches", [os.fspath(self._folder), *map(str, parts)])

    def find(self, part, entry):
        with self._lock:
            if part not in self._libraries:
                self._libraries[part] = self._open(part)
            return self._libraries[part], entry

    def _open(self, part):
        for _ in range(3):  # somebody may clear the cache in between
            if not (self._folder / "robot.json").exists():
                again = _build.run("build", _build.arguments(self._urdf, self._keywords))[1].rstrip("\n")
                if pathlib.Path(again) != self._folder:
                    raise _build.InputError(f"{self._urdf} is not what it was when it was loaded, and has no batches yet: load it again")
            self.prepare([part])
            marker, code = self._folder / f"batches_{part}.json", self._folder / f"batches_{part}.so"
            try:
                with open(marker, encoding="utf-8") as file:
                    if json.load(file)["code_bytes"] == os.path.getsize(code):
                        return _core.open(os.fspath(code))
                marker.unlink(missing_ok=True)  # a disk's doing
            except FileNotFoundError:
                continue
        raise RuntimeError(f"{self._folder} does not stay as it is made")


def _refuse_followers(what):
    raise NotImplementedError(f"{what} knows no joints that follow others: loops of this robot are embedded, and q has their dependent "
                              "joints, too. Move the independent positions and let close_loops() move the others, or leave "
                              "'independent' out of the loops")


class Rollout:
    """Motions that a function of a robot makes from states on, many steps in one call (docs/python.md)."""

    _METHODS = ("semi_implicit_euler", "rk4", "linearly_implicit")

    def __init__(self, function, name, takes, meaning, robot, run_time, linearly_implicit, switching):
        """switching: of what contacts and loops hold, (where each one's `active` is among the run-time inputs, the function that
        tells what an impact does or None, which of its results); else None."""
        self._function, self._takes, self._quaternions = function, takes, robot._quaternions
        self._has_followers = robot._has_followers()
        self._linearly_implicit, self._switching = linearly_implicit, switching
        switched = len(switching[0]) if switching else 0
        self.__name__ = self.__qualname__ = f"{name}_rollout"
        self._type = _results_type("Rollout", ("q", "v"))
        self.__doc__ = "\n".join((
            f"Motions of many steps, each with the acceleration that {name} computes; a named tuple.",
            "",
            f"q, v: ({robot.nq},) and ({robot.nv},), or (n, ...): where motions begin.",
            f"{takes}: (steps, {robot.nv}) for all motions, or (n, steps, {robot.nv}): {meaning}, held during a step. Without it "
            "nothing acts.",
            *(f"{i}: ({size},) or (n, {size}), the same in all steps, in place of the robot's own." for i, _, size in run_time),
            *([f"active: (steps, {switched}) for all motions, or (n, steps, {switched}): whether each contact, then each loop acts. Where "
               "one comes on that did not act in the step before, the step begins with an impact. Without it they act as the run-time "
               "inputs say."] if switched else ()),
            f"steps: how many, where {takes}{' and active do' if switched else ' does'} not say it.",
            "time_step: seconds; may be negative.",
            "method: 'semi_implicit_euler', of first order, one evaluation a step; 'rk4', of fourth order, four; or, where the robot "
            "is loaded with batch=True and rollouts=['linearly_implicit'], 'linearly_implicit', of first order, which bears stiff "
            "dampers and springs.",
            "path: whether the states behind each step are wanted, and not the last ones alone.",
            "out: (q, v), arrays to write to.",
            "return_status: also the step, from 0, that a motion could not make, or -1; of n motions an array.",
            "",
            "Returns, of n motions with n in front:",
            f"    q: ({robot.nq},), or with `path` (steps, {robot.nq})",
            f"    v: ({robot.nv},), or with `path` (steps, {robot.nv})"))
        P = inspect.Parameter
        self.__signature__ = inspect.Signature(
            [P("q", P.POSITIONAL_OR_KEYWORD), P("v", P.POSITIONAL_OR_KEYWORD), P(takes, P.POSITIONAL_OR_KEYWORD, default=None),
             P("time_step", P.KEYWORD_ONLY), P("steps", P.KEYWORD_ONLY, default=None),
             P("method", P.KEYWORD_ONLY, default="semi_implicit_euler"), P("path", P.KEYWORD_ONLY, default=False),
             *([P("active", P.KEYWORD_ONLY, default=None)] if switched else ()),
             *(P(i, P.KEYWORD_ONLY, default=None) for i, _, _ in run_time), P("out", P.KEYWORD_ONLY, default=None),
             P("return_status", P.KEYWORD_ONLY, default=False)])

    def __call__(self, q, v, *acting, time_step, steps=None, method="semi_implicit_euler", path=False, out=None,
                 return_status=False, **more):
        if self._has_followers:
            _refuse_followers(f"{self.__name__}()")
        if len(acting) > 1 or acting and self._takes in more:
            raise TypeError(f"{self.__name__} takes q, v, {self._takes} by place, and {self._takes} once")
        tau = acting[0] if acting else more.pop(self._takes, None)
        if method not in self._METHODS:
            raise ValueError(f"{self.__name__}: there is no method {method!r}" + _build.did_you_mean(method, self._METHODS))
        if method == "linearly_implicit" and not self._linearly_implicit:
            raise ValueError(f"{self.__name__}: linearly implicit steps are not in the code of this function: load the robot with "
                             "batch=True and rollouts=['linearly_implicit'], the function computing no derivatives beside it")
        active = more.pop("active", None) if self._switching else None
        if active is not None and self._switching[1] is None:
            raise ValueError(f"{self.__name__}: no function tells what an impact does where a contact comes on: add 'impact' to outputs")
        if active is not None and (given := numpy.asarray(active)).dtype.kind in "iuf" and not ((given == 0) | (given == 1)).all():
            raise ValueError(f"{self.__name__}: active is {given[(given != 0) & (given != 1)][0]} somewhere, expected true or false")
        if isinstance(out, (tuple, list)) and len(out) == 2 and all(isinstance(x, numpy.ndarray) for x in out) and numpy.shares_memory(*out):
            raise ValueError(f"{self.__name__}: out's two arrays share memory, expected one for q and one for v")
        if steps is None and tau is None and active is None and self.__signature__.parameters.keys() >= more.keys():
            raise TypeError(f"{self.__name__} needs steps, or {self._takes}, whose steps they are")
        if steps is not None and (not isinstance(steps, numbers.Integral) or steps < 0):
            raise ValueError(f"{self.__name__}: steps is {steps!r}, expected a whole number, 0 or more")
        if steps is not None and steps >= 2**31:
            raise ValueError(f"{self.__name__}: {steps} steps are more than there may be")
        if not isinstance(time_step, numbers.Real):
            raise TypeError(f"{self.__name__}: time_step is of type {type(time_step).__name__}, expected a number of seconds")
        return self._function.roll_out(
            self.__name__, q, v, tau, -1 if steps is None else int(steps), float(time_step), self._METHODS.index(method), path,
            out, return_status, {k: x for k, x in more.items() if x is not None},
            (active, *self._switching) if self._switching and self._switching[1] else None, self._quaternions, self._type)

    def __repr__(self):
        return f"<{self.__name__}{self.__signature__}>"


def _axes(shape, symbol):
    return "(" + ", ".join(map(str, shape)) + (",)" if len(shape) == 1 else ")") if shape else "a number"


class Robot:
    """A robot, by load(). What the scene asks for is a function of the same name, of one state or of n, row by row."""

    @classmethod
    def _of_entry(cls, folder, urdf, keywords):
        with open(folder / "robot.json", encoding="utf-8") as file:
            facts = json.load(file)
        code = folder / "code.so"
        if os.path.getsize(code) != facts["code_bytes"]:  # a disk's doing: without this file it is no entry, and made again
            (folder / "robot.json").unlink(missing_ok=True)
            raise FileNotFoundError(code)
        self = cls.__new__(cls)
        self.__dict__["_urdf"] = os.path.abspath(os.fspath(urdf))
        self.__dict__["_keywords"] = keywords = {k: os.path.abspath(os.fspath(x)) if k == "scene" and x is not None else x
                                                 for k, x in keywords.items()}
        self.__dict__["_folder"] = folder
        self.__dict__["_inputs"] = [_digest(file) for file in (self._urdf, keywords.get("scene"))]
        self._set_facts(facts)
        self._set_run_time(facts["run_time"])
        batches = None if keywords.get("batch") is False else _Batches(folder, self._urdf, self._keywords)
        if keywords.get("batch"):
            batches.prepare(sorted({f["part"] for f in facts["functions"] if f["batch_entry"] >= 0}))
        self._set_functions(_core.open(os.fspath(code)), batches, facts["functions"])
        for kind, text, alike in facts["said"]:
            if kind == "warning" and alike > 0:
                more = f" (the first of {alike} such warnings; the robot's notices are all)" if alike > 1 else ""
                warnings.warn(text + more, InputWarning, stacklevel=3)
        return self

    def _set_facts(self, facts):
        facts_of = self.__dict__
        facts_of.update(
            name=facts["robot"],
            source=self._folder / "source" / facts["name"],
            nq=facts["nq"],
            nv=facts["nv"],
            floating_base=facts["base"] == "floating",
            base_link=facts["base_link"],
            dtype=numpy.dtype(facts["scalar"]),
            joint_names=tuple(facts["joints"]),
            joint_types=tuple(facts["joint_types"]),
            body_names=tuple(facts["bodies"]),
            frame_names=tuple(facts["links"]),
            compiled_by=facts["compiled_by"],
            notices=tuple(text for _, text, _ in facts["said"]),
            _quaternions=numpy.array(facts["quaternions"], dtype=numpy.int64).reshape(-1, 3),
            _turning=tuple(["the base's quaternion"] * (facts["base"] == "floating") +
                           [f"the quaternion of joint '{joint}'" for joint in facts["quaternion_joints"]]),
        )
        for key, name in (("lower", "lower_limits"), ("upper", "upper_limits"), ("velocity", "velocity_limits"),
                          ("effort", "effort_limits")):
            values = numpy.array(facts[key], dtype=float)
            values.flags.writeable = False
            facts_of[name] = values

    def _set_run_time(self, inputs):
        values = numpy.array([x for i in inputs for x in i["start"]], dtype=self.dtype)
        self.__dict__["_run_time"] = values
        self.__dict__["_run_time_at"] = places = {}
        at = 0
        for i in inputs:
            places[i["name"]] = (at, len(i["start"]), i["unit"], i["help"])
            at += len(i["start"])

    def _set_functions(self, library, batches, functions):
        self.__dict__["_library"] = library
        base = ["the base's linear velocity along x", "along y", "along z", "the base's angular velocity about x", "about y",
                "about z"] if self.floating_base else []
        coordinates = tuple([f"{b} (v[{i}])" for i, b in enumerate(base)] +
                            [f"joint '{j}' (v[{len(base) + i}])" for i, j in enumerate(self.joint_names)])
        quaternions = tuple(zip(self._first_of_quaternions(), self._turning))
        run_time = tuple((name, at, size) for name, (at, size, _, _) in self._run_time_at.items())
        whole, single, results, scene_functions, callable_functions = {}, {}, {}, {}, []
        self.__dict__["_folders"] = {}
        for f in functions:
            one = len(f["results"]) == 1 and not f["named"]
            fields = tuple(r["field"] for r in f["results"])
            name = f["results"][0]["name"] if one else f["name"]
            solves = _core.has_constraint_status(library, f["entry"])
            made = _core.Function(
                library, f["entry"], name, f["takes"] or None, f["reads_velocities"], self.nq, self.nv,
                tuple(tuple(r["shape"]) for r in f["results"]), None if one else _results_type(f["name"], fields),
                self._run_time if run_time else None, run_time, coordinates, quaternions, self._docstring(f, one, solves), self._signature(f, run_time, solves),
                functools.partial(batches.find, f["part"], f["batch_entry"]) if batches and f["batch_entry"] >= 0 else None,
                f["acceleration"])
            if one or f["named"]:
                callable_functions.append((name, made, f))
            self._folders[name if one else f["name"]] = self._folder / "source" / f["folder"]
            if one:
                single[name] = made
            if not f["alone"]:
                whole[f["name"]] = (made, f, one)
            if f["named"]:
                scene_functions[f["name"]] = made
            else:
                for r in f["results"]:
                    results[r["name"]] = f
        rollouts = {f"{name}_rollout": Rollout(made, name, f["takes"], f["meaning"], self, run_time, f["linearly_implicit"],
                                               self._switching_of(f, callable_functions))
                    for name, made, f in callable_functions if f["acceleration"] >= 0}
        callables = {**single, **scene_functions}
        self.__dict__["_callables"], self.__dict__["outputs"] = callables, tuple(callables)
        taken = {name for name in scene_functions if hasattr(type(self), name) or name in self.__dict__ or keyword.iskeyword(name)}
        self.__dict__.update({name: made for name, made in {**rollouts, **callables}.items() if name not in taken})
        self.__dict__["_single"], self.__dict__["_whole"], self.__dict__["_function_of"] = single, whole, {
            name: f["function"] for name, f in results.items()}
        for name in sorted(taken):
            why = "is a keyword of Python" if keyword.iskeyword(name) else "is something that every robot has"
            warnings.warn(f"the function '{name}' is robot['{name}'] alone: '{name}' {why}", InputWarning, stacklevel=4)
        self.__dict__["_by_inputs"] = {f["takes"]: made for made, f, one in whole.values() if not one and not f["named"]}

    def _switching_of(self, f, functions):
        """What Rollout says of contacts and loops, of a function that they hold. An impact is told by the function itself or by
        another that takes no more than it does."""
        places = tuple(at for name, (at, *_) in self._run_time_at.items() if name.startswith(("contact_", "loop_")))
        if not places or f["results"][f["acceleration"]]["quantity"] != "constrained_forward_dynamics":
            return None
        tells = [(made, names.index("impact")) for made, g in
                 sorted(((made, g) for _, made, g in functions), key=lambda of: of[1] is not f)
                 if g["takes"] in ("", f["takes"]) and "impact" in (names := [r["quantity"] for r in g["results"]])]
        return (places, *(tells[0] if tells else (None, 0)))

    def _docstring(self, f, one, solves):
        lines = []
        if one:
            r = f["results"][0]
            of = f" of link {r['link']}" if r["link"] else ""
            symbol = f" ({r['symbol']})" if r["symbol"] else ""
            lines.append(f"{r['help'][0].upper() + r['help'][1:]}{symbol}{of}.")
        else:
            lines.append("Several quantities in one call, which computes what they share once; a named tuple.")
        lines.append("")
        layout = ("position of the base in the world (3), quaternion x y z w (4), joints", "the base's linear (3) and angular "
                  "velocity (3) in its own axes, joint rates") if self.floating_base else ("joints", "joint rates")
        lines.append(f"q: ({self.nq},) or (n, {self.nq}): {layout[0]}; m, rad.")
        lines.append(f"v: ({self.nv},) or (n, {self.nv}): {layout[1]}; m/s, rad/s." +
                     ("" if f["reads_velocities"] or f["takes"] else " Not read; may be left out."))
        if f["takes"]:
            lines.append(f"{f['takes']}: ({self.nv},) or (n, {self.nv}): {f['meaning']}.")
        for name, (_, size, unit, text) in self._run_time_at.items():
            lines.append(f"{name}: ({size},) or (n, {size}), in place of the robot's own: {text}; {unit}.")
        lines.append("out: an array, or one for each result, to write to." if one else "out: a tuple of arrays to write to.")
        lines.append("return_status: also the coordinate at which the mass matrix is not positive definite, nv + n where embedded loops' "
                     "linkage n is at a toggle point, or -1; with n states an array.")
        if solves:
            lines.append("return_constraint_status: also a dalembert.ConstraintStatus: residual, least_pivot and rank of the rows, numbers or, "
                         "with n states, arrays.")
        lines.append("")
        lines.append("Returns, of n states with n in front:")
        for r in f["results"]:
            lines.append(f"    {r['field']}: {_axes(r['shape'], r['symbol'])}, {r['unit']}" + ("" if one else f"; {r['help']}"))
        return "\n".join(lines)

    def _signature(self, f, run_time, solves):
        P = inspect.Parameter
        optional_v = not f["reads_velocities"] and not f["takes"]
        parameters = [P("q", P.POSITIONAL_OR_KEYWORD), P("v", P.POSITIONAL_OR_KEYWORD, default=None if optional_v else P.empty)]
        if f["takes"]:
            parameters.append(P(f["takes"], P.POSITIONAL_OR_KEYWORD))
        parameters += [P(name, P.KEYWORD_ONLY, default=None) for name, _, _ in run_time]
        parameters += [P("out", P.KEYWORD_ONLY, default=None), P("return_status", P.KEYWORD_ONLY, default=False)]
        if solves:
            parameters.append(P("return_constraint_status", P.KEYWORD_ONLY, default=False))
        return inspect.Signature(parameters)

    # ---- Several quantities

    def evaluate(self, q, v=None, *, a=None, tau=None, outputs=None, **more):
        """Several quantities in one call, as a named tuple.

        outputs: names of what load() was asked for, or what else the field calls it; without, all that q and v give (and with `a` or `tau`, all that these give).
        Quantities of one function (docs/scene.md) share what they share. `out`, in the order of `outputs`, and `return_status` and run-time inputs are
        those of the functions; with `return_status`, (results, status), status being -1 where M is positive definite everywhere;
        `return_constraint_status` goes with quantities of one function.
        """
        if outputs is None and (a is None or tau is None):  # all of one function, without further ado
            whole = self._by_inputs.get("a" if a is not None else "tau" if tau is not None else "")
            if whole and (v is not None or a is None and tau is None):
                return whole(q, *(x for x in (v, a, tau) if x is not None), **more)
        given = {"": True, "a": a is not None, "tau": tau is not None}
        if outputs is None:
            takes = [x for x in ("a", "tau") if given[x]] or [""]
            names = [n for n, f in self._function_of.items() if self._whole[f][1]["takes"] in takes]
            if not names:
                raise KeyError(f"{self.name} was loaded without quantities of " + " and ".join(["q", "v", *filter(None, takes)]))
        else:
            names = [_build.in_our_names(name) for name in ([outputs] if isinstance(outputs, str) else outputs)]
        for name in names:
            if name not in self._function_of:
                raise KeyError(self._unknown(name) if name not in self._whole else
                               f"'{name}' is a function of the scene, and not a quantity: call robot['{name}']")
        if len(set(names)) < len(names):
            raise ValueError(f"evaluate: '{next(n for n in names if names.count(n) > 1)}' is given twice in outputs")
        by_function = {}
        for name in names:
            by_function.setdefault(self._function_of[name], []).append(name)
        if "out" in more and len(by_function) > 1:
            raise TypeError("evaluate: `out` takes the quantities of one function; call it for each")
        if more.get("return_constraint_status") and len(by_function) > 1:
            raise TypeError("evaluate: `return_constraint_status` goes with the quantities of one function; call it for each")
        values, status, told = {}, None, ()
        for function, wanted in by_function.items():
            made, facts, one = self._whole[function]
            takes = facts["takes"]
            if takes and not given[takes]:
                raise TypeError(f"evaluate: {wanted[0]} needs {takes}")
            if len(wanted) == 1:
                made, one = self._single[wanted[0]], True
            elif "out" in more and len(wanted) < len(facts["results"]):
                raise TypeError(f"evaluate: with `out`, name one quantity or all of {function}: {', '.join(_fields(facts))}")
            extra = (a if takes == "a" else tau,) if takes else ()
            if extra and v is None:
                raise TypeError(f"evaluate: {wanted[0]} needs v")
            out = more.get("out")
            if not one and isinstance(out, (tuple, list)) and len(out) == len(wanted):  # in the order of outputs
                more["out"] = tuple(out[wanted.index(field)] for field in _fields(facts))
            result = made(q, *(() if v is None else (v,)), *extra, **more)
            if more.get("return_constraint_status"):
                *result, solved = result
                told = (solved,)
                result = tuple(result) if len(result) > 1 else result[0]
            if more.get("return_status"):
                result, of_this = result
                status = of_this if status is None else numpy.maximum(status, of_this)
            for name in wanted:
                values[name] = result if one else getattr(result, name)
        packed = _results_type("Results", tuple(names))(*(values[name] for name in names))
        told = ((status,) if more.get("return_status") else ()) + told
        return (packed, *told) if told else packed

    def __getitem__(self, name):
        """The function of that name, or of what else the field calls it: robot["mass_matrix"], and robot["crba"], is
        robot.mass_matrix. KeyError where there is none."""
        ours = name if name in self._callables else _build.in_our_names(name)
        if ours in self._callables:
            return self._callables[ours]
        raise KeyError(self._unknown(name))

    def source_of(self, name):
        """The folder of the C++ that a function of the robot is: that of the quantity alone; robot.source has the whole scene's."""
        ours = name if name in self._callables else _build.in_our_names(name)
        if ours not in self._callables:
            raise KeyError(self._unknown(name))
        return self._folders[ours]

    def _unknown(self, name):
        name = _build.in_our_names(name)
        known = list(self.outputs)
        if name in _build.quantities():
            return f"{self.name} was loaded without '{name}': add it to outputs; there are {', '.join(known)}"
        of = name[:-len("_rollout")] if isinstance(name, str) and name.endswith("_rollout") else ""
        if of in ("forward_dynamics", "constrained_forward_dynamics"):
            return f"{self.name} was loaded without '{of}', which '{name}' needs: add it to outputs; there are {', '.join(known)}"
        return f"there is no quantity '{name}'" + _build.did_you_mean(name, list(dict.fromkeys([*known, *_build.quantities()])))

    def __getattr__(self, name):  # of what is not in __dict__
        places = self.__dict__.get("_run_time_at", {})
        if name in places:
            at, size, _, _ = places[name]
            return self._run_time[at:at + size]
        if name.startswith("_"):
            raise AttributeError(name)
        if _build.in_our_names(name) in self._callables:
            return self[name]
        raise AttributeError(self._unknown(name))

    def __setattr__(self, name, value):
        places = self._run_time_at
        if name not in places:
            known = list(places)
            raise AttributeError(f"'{name}' cannot be set" + (_build.did_you_mean(name, known) if known else
                                 ": a scene with gravity: run_time, payloads or wrenches has what can"))
        at, size, unit, text = places[name]
        if isinstance(value, (Payload, Contact, Loop)):
            value = value.numbers(size)
        elif type(value) is tuple:
            value = _in_a_row(value)
        value = numpy.asarray(value)
        if value.shape != (size,) or value.dtype.kind not in "biuf":
            raise ValueError(f"{name} has shape {value.shape} and dtype {value.dtype}, expected ({size},): {text}, {unit}")
        _core.check_run_time_input(name, numpy.ascontiguousarray(value, dtype=float))
        self._run_time[at:at + size] = value

    # ---- States

    def neutral(self):
        """The state with every coordinate at zero, a floating base at the world's origin, upright; quaternions at no turn: (nq,)."""
        q = numpy.zeros(self.nq, self.dtype)
        for first in self._first_of_quaternions():
            q[first + 3] = 1
        return q

    def _first_of_quaternions(self):
        """Where in q quaternions begin."""
        return [3] * self.floating_base + [int(q) + 3 * int(slides) for q, _, slides in self._quaternions]

    def _has_followers(self):
        """Whether q has joints that follow others, their loops being embedded."""
        return self.nq != self.nv + self.floating_base + len(self._quaternions)

    def _of_own_joints(self, what):
        if self._has_followers():
            _refuse_followers(what)

    def random(self, rng=None, n=None):
        """A random state, or n of them: joints uniform within their limits (without limits ±π rad or ±1 m), a floating base within
        ±1 m, its orientation uniform. rng: a numpy Generator, or a seed. Returns (nq,) or (n, nq). NotImplementedError where loops are
        embedded, here and in what follows."""
        self._of_own_joints("random()")
        if n is not None and (not isinstance(n, numbers.Integral) or n < 0):
            raise ValueError(f"random: n is {n!r}, expected a whole number, 0 or more")
        rng = numpy.random.default_rng(rng)
        count = 1 if n is None else int(n)
        free = numpy.array([1.0 if t == "prismatic" else math.pi for t in self.joint_types])
        lower = numpy.where(numpy.isfinite(self.lower_limits), self.lower_limits, -free)
        upper = numpy.where(numpy.isfinite(self.upper_limits), self.upper_limits, free)
        low, high = numpy.minimum(lower, upper), numpy.maximum(lower, upper)
        q = numpy.empty((count, self.nq))
        base = 7 if self.floating_base else 0
        firsts = self._first_of_quaternions()
        # Every coordinate has a number of q, and a quaternion one more than its coordinates.
        places = [i for i in range(base, self.nq) if i - 3 not in firsts[len(firsts) - len(self._quaternions):]]
        q[:, places] = rng.uniform(low, high, (count, len(places)))
        if base:
            q[:, :3] = rng.uniform(-1, 1, (count, 3))
        for first in firsts:
            quaternion = rng.standard_normal((count, 4))
            q[:, first:first + 4] = quaternion / numpy.linalg.norm(quaternion, axis=1, keepdims=True)
        q = q.astype(self.dtype, copy=False)
        return q[0] if n is None else q

    def _rows(self, **arrays):
        """Arrays of one state or n, as float64 rows of as many states; and whether there was one state only."""
        rows, count = [], None
        for name, (value, size) in arrays.items():
            value = numpy.asarray(value)
            if value.dtype.kind not in "biuf" or value.ndim not in (1, 2) or value.shape[-1] != size:
                raise ValueError(f"{name} has shape {value.shape} and dtype {value.dtype}, expected ({size},) or (n, {size})")
            if value.ndim == 2:
                if count not in (None, len(value)):
                    raise ValueError(f"{name} has {len(value)} states, and others have {count}")
                count = len(value)
            rows.append(value.astype(numpy.float64, copy=False))
            for first, whose in zip(self._first_of_quaternions(), self._turning) if size == self.nq else ():
                zero = ~rows[-1][..., first:first + 4].any(-1)
                if zero.any():
                    of = f" of state {zero.argmax()}" if value.ndim == 2 else ""
                    raise ValueError(f"{name}[{first}] to {name}[{first + 3}]{of}, {whose}, are zero, expected a unit quaternion x y z w, such "
                                     "as 0 0 0 1: neutral() has it")
        n = 1 if count is None else count
        return [numpy.require(numpy.broadcast_to(r, (n, r.shape[-1])), requirements="CA") for r in rows], count is None

    def _as_given(self, rows, single):
        rows = rows.astype(self.dtype, copy=False)
        return rows[0] if single else rows

    def integrate(self, q, step):
        """Where the motion `step` (velocity times time: m, rad; (nv,) or (n, nv)) leads from q. A floating base turns and slides
        along a screw, on its group SE(3), as in dalembert/integrators of the C++ runtime, as do floating joints; spherical ones turn,
        others add."""
        self._of_own_joints("integrate()")
        (q, step), single = self._rows(q=(q, self.nq), step=(step, self.nv))
        return self._as_given(_core.integrate(q, step, self._quaternions), single)

    def difference(self, start, end):
        """The step that integrate() leads from `start` to `end`: (nv,) or (n, nv). A floating base turns by at most half a turn."""
        self._of_own_joints("difference()")
        (start, end), single = self._rows(start=(start, self.nq), end=(end, self.nq))
        return self._as_given(_core.difference(start, end, self.floating_base, self._quaternions), single)

    def interpolate(self, start, end, fraction):
        """`start` at fraction 0, `end` at 1, between them along the step that leads there: on a floating base a screw. A fraction may
        be a number or an array of n."""
        self._of_own_joints("interpolate()")
        fraction = numpy.asarray(fraction)
        if fraction.dtype.kind not in "biuf":
            raise ValueError(f"fraction has dtype {fraction.dtype}, expected a number or (n,)")
        fraction = fraction.astype(float, copy=False)
        (start, end), single = self._rows(start=(start, self.nq), end=(end, self.nq))
        step = _core.difference(start, end, self.floating_base, self._quaternions)
        if fraction.ndim not in (0, 1):
            raise ValueError(f"fraction has shape {fraction.shape}, expected a number or (n,)")
        if fraction.ndim == 1:
            if len(start) not in (1, len(fraction)):
                raise ValueError(f"fraction has {len(fraction)} numbers, and there are {len(start)} states")
            single = False
        step = fraction[..., None] * step
        start = numpy.ascontiguousarray(numpy.broadcast_to(start, (len(step), self.nq)))
        return self._as_given(_core.integrate(start, numpy.ascontiguousarray(step), self._quaternions), single)

    def close_loops(self, q, *, return_status=False):
        """q with embedded loops closed: their dependent joints move by eight steps of Newton's from where they are, which keeps a
        linkage in its branch, all others stay. A row of q is as the C++ function of that name leaves it. return_status: also a
        dalembert.LinkageStatus; without, one state at a toggle point raises SingularError, of n they warn, and so do loops that stay
        open by more than 1e-6 (float32: 1e-3)."""
        if not self._has_followers():
            raise ValueError("close_loops: no loop of this robot is embedded: q has no joints that follow others; name 'independent' "
                             "joints of a loop when the robot is loaded")
        (rows,), single = self._rows(q=(q, self.nq))
        if single and not numpy.isfinite(rows).all():
            at = int(numpy.isfinite(rows[0]).argmin())
            raise ValueError(f"close_loops: q[{at}] is {rows[0, at]}, and the function needs finite numbers")
        finite = numpy.isfinite(rows).all(axis=1)
        rows = numpy.array(rows, dtype=self.dtype, order="C")
        told = _core.close_loops(self._library, rows)
        error, least_pivot, linkage = told[:, 0].copy(), told[:, 1].copy(), told[:, 2].astype(numpy.int32)
        result = rows[0] if single else rows
        if return_status:
            return result, LinkageStatus(error[0].item(), least_pivot[0].item(), linkage[0].item()) if single else LinkageStatus(
                error, least_pivot, linkage)
        toggle = (linkage >= 0) & finite
        if not finite.all():
            warnings.warn(f"close_loops: {(~finite).sum()} of {len(rows)} states, the first of them number {finite.argmin()}, have numbers that are "
                          "not finite, and stay as they are", RuntimeWarning, stacklevel=2)
        if single and toggle[0]:
            raise _core.SingularError(f"close_loops: linkage {linkage[0]} (from 0) is at a toggle point: its loops do not tell where the "
                                      "joints that follow go")
        if toggle.any():
            warnings.warn(f"close_loops: loops are at toggle points at {toggle.sum()} of {len(rows)} states, the first of them number "
                          f"{toggle.argmax()}: joints that follow stay where they were; return_status=True tells which",
                          _core.SingularWarning, stacklevel=2)
        left = numpy.where(toggle | ~finite, 0.0, error)
        if left.max(initial=0) > (1e-6 if self.dtype == numpy.float64 else 1e-3):
            warnings.warn(f"close_loops: loops stay open by up to {left.max():.3g} (m, rad)" +
                          ("" if single else f" at state {left.argmax()}") + ": begin nearer to where they are closed", RuntimeWarning,
                          stacklevel=2)
        return result

    # ---- The generator's other commands, of this robot and scene

    def info(self, *, text=False):
        """dalembert.info() of this robot and scene."""
        return _build.info(self._urdf, text=text, **self._without_compiler())

    def check(self):
        """dalembert.check() of this robot and scene: (passed, text)."""
        return _build.check(self._urdf, **self._keywords)

    def report(self, folder, *, quick=False):
        """dalembert.report() of this robot and scene: (passed, text)."""
        return _build.report(self._urdf, folder, quick=quick, **self._keywords)

    def _without_compiler(self):
        return {k: v for k, v in self._keywords.items() if k not in ("compiler", "flags", "lanes")}

    # ---- As a value

    def __reduce__(self):
        return _again, (os.fspath(self._folder), self._urdf, self._keywords, self._run_time.copy(), self._inputs)

    def __repr__(self):
        return (f"<dalembert.Robot {self.name}: {'floating' if self.floating_base else 'fixed'} base, nq = {self.nq}, "
                f"nv = {self.nv}, {', '.join(self.outputs)}>")

    def __dir__(self):
        return sorted({n for n in (*self.__dict__, *dir(type(self)), *self._run_time_at) if not n.startswith("_")})


def _fields(facts):
    return [r["field"] for r in facts["results"]]


def _digest(file):
    """Of a file's bytes, or None."""
    try:
        return hashlib.sha256(pathlib.Path(file).read_bytes()).hexdigest() if file else None
    except OSError:
        return None


def _again(folder, urdf, keywords, run_time, inputs):
    """A pickled robot: the same compiled code where it is still kept, else loaded again from the same inputs."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputWarning)  # said when it was loaded
            robot = Robot._of_entry(pathlib.Path(folder), urdf, keywords)
    except FileNotFoundError:
        robot = load(urdf, **keywords)
        for file, was, now in zip((urdf, keywords.get("scene")), inputs, robot._inputs):
            if was != now:
                raise ValueError(f"{file} is not what it was when the robot that is pickled was loaded: load it again")
    robot._run_time[:] = run_time
    robot.__dict__["_inputs"] = inputs  # of its code: files may be others by now
    return robot
