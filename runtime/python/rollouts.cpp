#include "rollouts.hpp"

#include <algorithm>
#include <atomic>
#include <climits>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "call.hpp"
#include "function.hpp"
#include "motions.hpp"
#include "single_steps.hpp"
#include "workers.hpp"

namespace dalembert::python {

namespace {

bool take_per_step(const Contents& f, PyObject* object, PyObject* name, npy_intp size, PerStep& to) {
  if (object == Py_None) return true;
  Owned array(PyArray_Check(object) ? Py_NewRef(object) : PyArray_FromAny(object, nullptr, 0, 0, 0, nullptr));
  if (!array) return false;
  const int type = PyArray_TYPE(array.array()), dimensions = PyArray_NDIM(array.array());
  if (!PyTypeNum_ISBOOL(type) && !PyTypeNum_ISINTEGER(type) && !PyTypeNum_ISFLOAT(type)) {
    PyErr_Format(PyExc_ValueError, "%U: %U has dtype %S, expected numbers", f.name, name, PyArray_DESCR(array.array()));
    return false;
  }
  if (dimensions < 2 || dimensions > 3 || PyArray_DIM(array.array(), dimensions - 1) != size) {
    std::string shape;
    for (int i = 0; i < dimensions; ++i) shape += (i ? ", " : "") + std::to_string(PyArray_DIM(array.array(), i));
    PyErr_Format(PyExc_ValueError, "%U: %U has shape (%s%s), expected (steps, %zd) for all motions or (n, steps, %zd)", f.name,
                 name, shape.c_str(), dimensions == 1 ? "," : "", static_cast<Py_ssize_t>(size), static_cast<Py_ssize_t>(size));
    return false;
  }
  const auto bytes = static_cast<npy_intp>(f.scalar);
  bool as_it_is = type == f.type && PyArray_ISALIGNED(array.array()) && PyArray_ISNOTSWAPPED(array.array());
  for (int i = 0; i < dimensions; ++i) as_it_is = as_it_is && PyArray_STRIDE(array.array(), i) % bytes == 0;
  if (!as_it_is) {
    array = Owned(PyArray_FROM_OTF(array.get(), f.type, NPY_ARRAY_CARRAY_RO | NPY_ARRAY_FORCECAST));
    if (!array) return false;
  }
  to.first = PyArray_DATA(array.array());
  to.number = PyArray_STRIDE(array.array(), dimensions - 1) / bytes;
  to.step = PyArray_STRIDE(array.array(), dimensions - 2) / bytes;
  to.steps = PyArray_DIM(array.array(), dimensions - 2);
  if (dimensions == 3) {
    to.motion = PyArray_STRIDE(array.array(), 0) / bytes;
    to.array.states = PyArray_DIM(array.array(), 0);
  }
  to.array.array = std::move(array);
  return true;
}

// What a thread computes in.
struct Workspaces {
  Workspace motion;
  std::optional<Workspace> impact;
};

// What all parts of a call have in common.
struct Motions {
  const Contents& f;
  const Code& code;
  const Switching& switching;
  const std::vector<QuaternionJoint>& joints;

  void run(const RolloutCall& part, const Workspaces& in) const {
    if (code.entry->roll_out) return code.entry->roll_out(part, in.motion.get());
    if (f.type == NPY_DOUBLE) singly<double>(part, in);
    else singly<float>(part, in);
  }

 private:
  template <class T>
  void singly(const RolloutCall& part, const Workspaces& in) const {
    SingleSteps<T>(f, switching, part, joints, in.motion.get(), in.impact ? in.impact->get() : nullptr).run();
  }
};

// On several threads where that pays. Without the GIL.
void run_motions(const Motions& motions, const RolloutCall& call, const std::vector<Workspaces>& workspaces) {
  const int threads = static_cast<int>(workspaces.size());
  if (threads == 1) return motions.run(call, workspaces[0]);
  // Whole registers, whatever their width.
  const std::ptrdiff_t chunk = (std::max<std::ptrdiff_t>(1, call.end / (8 * threads)) + 15) / 16 * 16;
  std::atomic<std::ptrdiff_t> next{0};
  Workers::instance().run(threads, [&](int w) {
    RolloutCall part = call;
    while ((part.begin = next.fetch_add(chunk)) < call.end) {
      part.end = std::min(call.end, part.begin + chunk);
      motions.run(part, workspaces[static_cast<std::size_t>(w)]);
    }
  });
}

bool take_switching(const Contents& f, PyObject* object, Switching& to) {
  if (object == Py_None) return true;
  PyObject *active, *places, *impact;
  if (!PyArg_ParseTuple(object, "OO!O!i", &active, &PyTuple_Type, &places, &function_type, &impact, &to.impact_result))
    return false;
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(places); ++i)
    to.places.push_back(static_cast<int>(PyLong_AsLong(PyTuple_GET_ITEM(places, i))));
  to.impact = reinterpret_cast<Function*>(impact)->contents;
  return !PyErr_Occurred() && take_per_step(f, active, name_active, PyTuple_GET_SIZE(places), to.active);
}

}  // namespace

PyObject* roll_out(PyObject* self, PyObject* args) {
  Contents& f = *reinterpret_cast<Function*>(self)->contents;
  PyObject *name, *q_object, *v_object, *more_object, *out, *run_time, *switching_object, *type;
  PyArrayObject* quaternions;
  Py_ssize_t steps;
  double time_step;
  int method, path, return_status;
  if (!PyArg_ParseTuple(args, "UOOOndipOpO!OO!O", &name, &q_object, &v_object, &more_object, &steps, &time_step, &method, &path,
                        &out, &return_status, &PyDict_Type, &run_time, &switching_object, &PyArray_Type, &quaternions, &type))
    return nullptr;
  std::vector<QuaternionJoint> joints;
  if (!quaternion_joints(quaternions, joints)) return nullptr;
  if (f.acceleration < 0) return PyErr_Format(PyExc_TypeError, "%U: the function does not tell how the robot moves", name);
  // What messages name and results are; nothing of it is owned.
  Contents of_rollout = f;
  of_rollout.name = name;
  of_rollout.result_type = type;
  Given given;
  given.run_time.assign(f.run_time_inputs.size(), nullptr);
  PyObject *key, *value;
  for (Py_ssize_t at = 0; PyDict_Next(run_time, &at, &key, &value);) {
    const auto found = std::find_if(f.run_time_inputs.begin(), f.run_time_inputs.end(),
                                    [&](const RunTimeInput& input) { return PyUnicode_Compare(input.name, key) == 0; });
    if (found == f.run_time_inputs.end()) {
      std::string known = std::string("q, v, ") + PyUnicode_AsUTF8(f.more);
      for (const RunTimeInput& input : f.run_time_inputs) known += std::string(", ") + PyUnicode_AsUTF8(input.name);
      if (switching_object != Py_None) known += ", active";
      return PyErr_Format(PyExc_TypeError,
                          "%U has no argument '%U'; there are %s, steps, time_step, method, path, out and return_status", name,
                          key, known.c_str());
    }
    given.run_time[static_cast<std::size_t>(found - f.run_time_inputs.begin())] = value;
  }

  Argument q, v;
  PerStep acting;
  Switching switching;
  if (!take(of_rollout, q_object, name_q, f.nq, q) || !take(of_rollout, v_object, name_v, f.nv, v) ||
      !take_per_step(of_rollout, more_object, f.more, f.nv, acting) || !take_switching(of_rollout, switching_object, switching))
    return nullptr;
  npy_intp motions = -1;
  PyObject* first = nullptr;
  for (const auto& [argument, of] :
       {std::pair{&q, name_q}, {&v, name_v}, {&acting.array, f.more}, {&switching.active.array, name_active}}) {
    if (argument->states < 0) continue;
    if (motions >= 0 && argument->states != motions)
      return PyErr_Format(PyExc_ValueError, "%U: %U has %zd motions and %U has %zd", name, first,
                          static_cast<Py_ssize_t>(motions), of, static_cast<Py_ssize_t>(argument->states));
    motions = argument->states;
    if (!first) first = of;
  }
  const char* of_steps = "`steps`";
  for (const auto& [per_step, of] : {std::pair{&acting, f.more}, {&switching.active, name_active}}) {
    if (per_step->steps < 0) continue;
    if (steps >= 0 && per_step->steps != steps)
      return PyErr_Format(PyExc_ValueError, "%U: %U has %zd steps, and %s %s %zd", name, of,
                          static_cast<Py_ssize_t>(per_step->steps), of_steps, *of_steps == '`' ? "is" : "has", steps);
    steps = per_step->steps, of_steps = PyUnicode_AsUTF8(of);
  }
  if (steps > INT_MAX) return PyErr_Format(PyExc_ValueError, "%U: %zd steps are more than there may be", name, steps);
  if (!std::isfinite(time_step)) return PyErr_Format(PyExc_ValueError, "%U: time_step is not a finite number of seconds", name);

  RolloutCall call{};
  std::vector<Argument> own;
  std::vector<unsigned char> memory;
  if (!take_run_time(of_rollout, given, own, motions, memory, call.run_time)) return nullptr;
  const bool many = motions >= 0;
  of_rollout.shapes.clear();
  for (const npy_intp size : {f.nq, f.nv}) {
    if (path) of_rollout.shapes.push_back({2, {steps, size}});
    else of_rollout.shapes.push_back({1, {size, 1}});
  }
  Results results;
  if (!prepare_results(of_rollout, out == Py_None ? nullptr : out, motions, {&q, &v, &acting.array, &switching.active.array},
                       results))
    return nullptr;
  if (!are_quaternions(of_rollout, q.rows, q.states >= 0 ? motions : -1)) return nullptr;
  npy_intp count = many ? motions : 1;
  Owned status(PyArray_SimpleNew(1, &count, NPY_INT32));
  if (!status) return nullptr;

  call.q = q.rows, call.v = v.rows;
  call.more = acting.first;
  call.more_motion = acting.motion, call.more_step = acting.step, call.more_number = acting.number;
  call.steps = static_cast<std::size_t>(steps), call.time_step = time_step, call.method = static_cast<RolloutMethod>(method);
  call.stopped = static_cast<std::int32_t*>(PyArray_DATA(status.array()));
  call.end = count;
  const auto into = [&](std::size_t i) {
    return PyArray_DATA((results.written_to[i] ? results.written_to[i] : results.arrays[i]).array());
  };
  (path ? call.path_q : call.last_q) = into(0);
  (path ? call.path_v : call.last_v) = into(1);
  const bool by_single_steps = switching.active.steps >= 0;
  if (count > 0 && !by_single_steps && !find_batch(f)) return nullptr;
  Code& code = !by_single_steps && f.batch.entry && f.batch.entry->roll_out ? f.batch : f.single;
  {
    // Waking threads takes longer than some hundred states.
    const bool alone = static_cast<double>(count) * static_cast<double>(steps) < 256;
    const npy_intp most = alone ? 1 : std::min<npy_intp>((count + 15) / 16, Workers::instance().count());
    std::vector<Workspaces> workspaces;
    for (npy_intp w = 0; w < std::max<npy_intp>(1, most); ++w) {
      workspaces.push_back({Workspace(code), {}});
      if (switching.impact) workspaces.back().impact.emplace(switching.impact->single);
      if (!workspaces.back().motion.get() || (switching.impact && !workspaces.back().impact->get())) return PyErr_NoMemory();
    }
    Contents of_states = f;  // as `f`, whose own may change while others hold the GIL
    Py_BEGIN_ALLOW_THREADS;
    run_motions({of_states, code, switching, joints}, call, workspaces);
    Py_END_ALLOW_THREADS;
  }
  for (std::size_t i = 0; i < results.arrays.size(); ++i)
    if (results.written_to[i] && PyArray_CopyInto(results.arrays[i].array(), results.written_to[i].array()) < 0) return nullptr;
  const std::int32_t* const stopped = call.stopped;
  if (!return_status) {
    const std::ptrdiff_t few = std::count_if(stopped, stopped + count, [](std::int32_t s) { return s >= 0; });
    const std::ptrdiff_t at = std::find_if(stopped, stopped + count, [](std::int32_t s) { return s >= 0; }) - stopped;
    if (few > 0 &&
        PyErr_WarnFormat(stopped_warning, 1,
                         "%U: %zd of %zd motions stopped, the first of them number %zd in step %d: M is not positive definite "
                         "there, or a number would not be finite; it stays where it was. return_status=True tells which",
                         name, static_cast<Py_ssize_t>(few), static_cast<Py_ssize_t>(count), static_cast<Py_ssize_t>(at),
                         static_cast<int>(stopped[at])) < 0)
      return nullptr;
  }
  Owned both(packed(of_rollout, results.arrays, false));
  if (!both || !return_status) return both.release();
  if (many) return Py_BuildValue("(NN)", both.release(), status.release());
  return Py_BuildValue("(Ni)", both.release(), stopped[0]);
}

}  // namespace dalembert::python
