"""Arguments made up by Hypothesis: whatever is given is right or refused, by an error of ours. A slice of it is in the suite;
fuzz.py runs it long, under sanitizers."""

import warnings

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import dalembert

numbers = st.one_of(st.floats(allow_nan=True, allow_infinity=True, width=32), st.integers(-10, 10))
sizes = st.sampled_from([0, 1, 2, 3, 8, 9, 10])
dtypes = st.sampled_from(["f8", "f4", ">f8", "i4", "u1", "?", "c16", "O", "U3", "f2", "g"])


@st.composite
def arrays(draw):
    """Of any shape, dtype and layout."""
    shape = draw(st.lists(sizes, max_size=3))
    fill = draw(numbers)
    array = np.zeros([2 * s for s in shape], "f8")
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        array[...] = fill
        try:
            array = array.astype(draw(dtypes))
        except (ValueError, OverflowError):
            pass
    return laid_out(array, tuple(shape), draw(st.integers(0, 4)))


def laid_out(array, shape, how):
    """Every other entry, backwards, in Fortran's order, read-only, as it is."""
    view = array[tuple(slice(None, None, -2 if how == 1 else 2) for _ in shape)] if how else array[tuple(slice(s) for s in shape)]
    if how == 3:
        view = np.asfortranarray(view)
    if how == 4:
        view = np.ascontiguousarray(view)
        view.flags.writeable = False
    return view


@st.composite
def fitting(draw, size):
    """An array that may well be right."""
    n = draw(st.sampled_from([None, 0, 1, 3, 5, 70]))
    shape = (size,) if n is None else (n, size)
    array = np.full([2 * s for s in shape], draw(numbers), "f8")
    if draw(st.booleans()):
        array[...] = np.random.default_rng(draw(st.integers(0, 9))).uniform(-1, 1, array.shape)
    with np.errstate(all="ignore"):
        array = array.astype(draw(st.sampled_from(["f8", "f8", "f8", "f4"])))
    return laid_out(array, shape, draw(st.integers(0, 4)))


def huge(size):
    """More states than there is memory for, of a few bytes."""
    return st.just(10**15).map(lambda n: np.broadcast_to(np.zeros(size), (n, size)))


def right_or_refused(robots, cases):
    names = ("wrench_link_02", 6), ("payload_link_02", 10), ("gravity_vector", 3)

    @settings(max_examples=cases, deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(data=st.data())
    def run(data):
        robot = data.draw(st.sampled_from(robots))
        of = lambda size: data.draw(st.one_of(fitting(size), fitting(size), fitting(size), arrays(), st.none(), huge(size)))
        if data.draw(st.integers(0, 9)) == 0:
            move = getattr(robot, data.draw(st.sampled_from(["integrate", "difference", "interpolate"])))
            of = lambda size: data.draw(st.one_of(fitting(size), fitting(size), arrays(), st.none()))
            arguments = [of(robot.nq), of(data.draw(st.sampled_from([robot.nv, robot.nq])))]
            if move.__name__ == "interpolate":
                arguments.append(data.draw(st.one_of(numbers, arrays())))
            try:
                move(*arguments)
            except (ValueError, TypeError, MemoryError, OverflowError):
                pass
            return
        if data.draw(st.integers(0, 4)) == 0 and "forward_dynamics" in robot.outputs:
            steps = data.draw(st.sampled_from([0, 1, 2, 3]))
            acting = lambda: data.draw(st.one_of(
                st.none(), arrays(), fitting(robot.nv).map(lambda a: a[..., None, :].repeat(steps, -2)),
                huge(robot.nv).map(lambda a: np.broadcast_to(a[:, None], (len(a), steps, robot.nv)))))
            keywords = {"time_step": data.draw(st.one_of(st.sampled_from([0.01, -0.1, 1e9]), numbers)),
                        "method": data.draw(st.sampled_from(["rk4", "semi_implicit_euler", "euler", 1])),
                        "path": data.draw(st.booleans())}
            for key, value in (("tau", acting), ("out", lambda: (of(robot.nq), of(robot.nv))), ("return_status", st.booleans),
                               *((name, lambda size=size: of(size)) for name, size in names)):
                if data.draw(st.integers(0, 2)) == 0:
                    keywords[key] = data.draw(value()) if key == "return_status" else value()
            if "tau" not in keywords or data.draw(st.integers(0, 5)) == 0:
                keywords["steps"] = data.draw(st.sampled_from([steps, steps, -1, 1.5, 2**40]))
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    result = robot.forward_dynamics_rollout(of(robot.nq), of(robot.nv), **keywords)
            except (ValueError, TypeError, MemoryError):
                return
            q, v = result[0] if keywords.get("return_status") else result
            assert q.shape[:-1] == v.shape[:-1] and (q.shape[-1], v.shape[-1]) == (robot.nq, robot.nv), (q.shape, v.shape)
            return
        function = robot[data.draw(st.sampled_from(robot.outputs))]
        arguments = [of(robot.nq), of(robot.nv), of(robot.nv)][:data.draw(st.integers(0, 3))]
        keywords = {}
        for key, size in (("out", robot.nv), *names, ("tau", robot.nv)):
            if data.draw(st.integers(0, 5)) == 0:
                keywords[key] = of(size)
        if data.draw(st.booleans()):
            keywords["return_status"] = True
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = function(*arguments, **keywords)
        except (ValueError, TypeError, MemoryError, dalembert.SingularError):
            return
        result = result[0] if keywords.get("return_status") else result
        states = [len(a) for a in (*arguments, *keywords.values())
                  if isinstance(a, np.ndarray) and a.ndim == 2 and a is not keywords.get("out")]
        for value in result if isinstance(result, tuple) else (result,):
            if states and not isinstance(keywords.get("out"), tuple):
                assert np.shape(value)[0] == states[0], (np.shape(value), states)

    run()
