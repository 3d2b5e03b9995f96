#include "rollouts.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <climits>
#include <cmath>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "call.hpp"
#include "function.hpp"
#include "motions.hpp"
#include "workers.hpp"

namespace dalembert::python {

namespace {

// What acts in each step: (steps, nv) for all motions, or (n, steps, nv).
struct Acting {
  Argument array;  // its owner, and how many motions there are
  const void* first = nullptr;
  std::ptrdiff_t motion = 0, step = 0, number = 0;  // in numbers
  npy_intp steps = -1;                              // -1: nothing acts
};

bool take_acting(const Contents& f, PyObject* object, Acting& to) {
  if (object == Py_None) return true;
  Owned array(PyArray_Check(object) ? Py_NewRef(object) : PyArray_FromAny(object, nullptr, 0, 0, 0, nullptr));
  if (!array) return false;
  const int type = PyArray_TYPE(array.array()), dimensions = PyArray_NDIM(array.array());
  if (!PyTypeNum_ISBOOL(type) && !PyTypeNum_ISINTEGER(type) && !PyTypeNum_ISFLOAT(type)) {
    PyErr_Format(PyExc_ValueError, "%U: %U has dtype %S, expected numbers", f.name, f.more, PyArray_DESCR(array.array()));
    return false;
  }
  if (dimensions < 2 || dimensions > 3 || PyArray_DIM(array.array(), dimensions - 1) != f.nv) {
    std::string shape;
    for (int i = 0; i < dimensions; ++i) shape += (i ? ", " : "") + std::to_string(PyArray_DIM(array.array(), i));
    PyErr_Format(PyExc_ValueError, "%U: %U has shape (%s%s), expected (steps, %zd) for all motions or (n, steps, %zd)", f.name,
                 f.more, shape.c_str(), dimensions == 1 ? "," : "", static_cast<Py_ssize_t>(f.nv),
                 static_cast<Py_ssize_t>(f.nv));
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

// One motion after another, by the function at single states.
template <class T>
class Singly {
 public:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  std::vector<QuaternionJoint> quaternion_joints;

  Singly(const Contents& f, const RolloutCall& call, std::vector<QuaternionJoint> joints, void* workspace)
      : quaternion_joints(std::move(joints)), f_(f), call_(call), workspace_(workspace), input_(f.nv) {
    for (const Shape& shape : f.shapes) results_.emplace_back(static_cast<std::size_t>(shape.size[0] * shape.size[1]));
    for (std::vector<T>& result : results_) pointers_.push_back(result.data());
  }

  Vector acceleration(const Vector& q, const Vector& v) {
    FunctionCall one{};
    one.q.first = q.data(), one.v.first = v.data(), one.more.first = input_.data();
    one.run_time.first = static_cast<const T*>(call_.run_time.first) + motion_ * call_.run_time.step;
    std::int32_t status = -1;
    one.results = pointers_.data(), one.status = f_.single.entry->has_status ? &status : nullptr, one.end = 1;
    f_.single.entry->run(one, workspace_);
    worst_ = std::max(worst_, status);
    const auto at = static_cast<std::size_t>(f_.acceleration);
    return Eigen::Map<const Vector>(results_[at].data(), f_.nv);
  }

  void run() {
    const auto steps = static_cast<std::ptrdiff_t>(call_.steps);
    const auto h = static_cast<T>(call_.time_step);
    const auto read = [&](const StateRows& rows, npy_intp size) {
      return Vector(Eigen::Map<const Vector>(static_cast<const T*>(rows.first) + motion_ * rows.step, size));
    };
    const auto write = [](const Vector& from, void* to, std::ptrdiff_t row) {
      if (to) std::copy_n(from.data(), from.size(), static_cast<T*>(to) + row * from.size());
    };
    for (motion_ = call_.begin; motion_ < call_.end; ++motion_) {
      Vector q = read(call_.q, f_.nq), v = read(call_.v, f_.nv);
      std::int32_t stopped = -1;
      for (std::ptrdiff_t step = 0; step < steps; ++step) {
        if (stopped < 0) {
          const T* const acts = static_cast<const T*>(call_.more);
          for (npy_intp i = 0; i < f_.nv; ++i)
            input_[i] = acts ? acts[motion_ * call_.more_motion + step * call_.more_step + i * call_.more_number] : T(0);
          Vector next_q = q, next_v = v;
          worst_ = -1;
          if (call_.method == RolloutMethod::rk4) integrators::rk4(*this, h, next_q, next_v);
          else integrators::semi_implicit_euler(*this, h, next_q, next_v);
          if (worst_ >= 0 || !next_q.allFinite() || !next_v.allFinite()) stopped = static_cast<std::int32_t>(step);
          else q = next_q, v = next_v;
        }
        write(q, call_.path_q, motion_ * steps + step);
        write(v, call_.path_v, motion_ * steps + step);
      }
      write(q, call_.last_q, motion_);
      write(v, call_.last_v, motion_);
      call_.stopped[motion_] = stopped;
    }
  }

 private:
  const Contents& f_;
  const RolloutCall& call_;
  void* workspace_;
  Vector input_;
  std::vector<std::vector<T>> results_;
  std::vector<void*> pointers_;
  std::ptrdiff_t motion_ = 0;
  std::int32_t worst_ = -1;
};

void run_part(const Contents& f, const Code& code, const RolloutCall& part, const std::vector<QuaternionJoint>& joints,
              void* workspace) {
  if (code.entry->roll_out) return code.entry->roll_out(part, workspace);
  if (f.type == NPY_DOUBLE) return Singly<double>(f, part, joints, workspace).run();
  Singly<float>(f, part, joints, workspace).run();
}

// On several threads where that pays. Without the GIL.
void run_motions(const Contents& f, const Code& code, const RolloutCall& call, const std::vector<QuaternionJoint>& joints,
                 const std::vector<Workspace>& workspaces) {
  const int threads = static_cast<int>(workspaces.size());
  if (threads == 1) return run_part(f, code, call, joints, workspaces[0].get());
  // Whole registers, whatever their width.
  const std::ptrdiff_t chunk = (std::max<std::ptrdiff_t>(1, call.end / (8 * threads)) + 15) / 16 * 16;
  std::atomic<std::ptrdiff_t> next{0};
  Workers::instance().run(threads, [&](int w) {
    RolloutCall part = call;
    while ((part.begin = next.fetch_add(chunk)) < call.end) {
      part.end = std::min(call.end, part.begin + chunk);
      run_part(f, code, part, joints, workspaces[static_cast<std::size_t>(w)].get());
    }
  });
}

}  // namespace

PyObject* roll_out(PyObject* self, PyObject* args) {
  Contents& f = *reinterpret_cast<Function*>(self)->contents;
  PyObject *name, *q_object, *v_object, *more_object, *out, *run_time, *type;
  PyArrayObject* quaternions;
  Py_ssize_t steps;
  double time_step;
  int method, path, return_status;
  if (!PyArg_ParseTuple(args, "UOOOndipOpO!O!O", &name, &q_object, &v_object, &more_object, &steps, &time_step, &method, &path,
                        &out, &return_status, &PyDict_Type, &run_time, &PyArray_Type, &quaternions, &type))
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
      return PyErr_Format(PyExc_TypeError,
                          "%U has no argument '%U'; there are %s, steps, time_step, method, path, out and return_status", name,
                          key, known.c_str());
    }
    given.run_time[static_cast<std::size_t>(found - f.run_time_inputs.begin())] = value;
  }

  Argument q, v;
  Acting acting;
  if (!take(of_rollout, q_object, name_q, f.nq, q) || !take(of_rollout, v_object, name_v, f.nv, v) ||
      !take_acting(of_rollout, more_object, acting))
    return nullptr;
  npy_intp motions = -1;
  PyObject* first = nullptr;
  for (const auto& [argument, of] : {std::pair{&q, name_q}, {&v, name_v}, {&acting.array, f.more}}) {
    if (argument->states < 0) continue;
    if (motions >= 0 && argument->states != motions)
      return PyErr_Format(PyExc_ValueError, "%U: %U has %zd motions and %U has %zd", name, first,
                          static_cast<Py_ssize_t>(motions), of, static_cast<Py_ssize_t>(argument->states));
    motions = argument->states;
    if (!first) first = of;
  }
  if (acting.steps >= 0 && steps >= 0 && acting.steps != steps)
    return PyErr_Format(PyExc_ValueError, "%U: %U has %zd steps, and `steps` is %zd", name, f.more,
                        static_cast<Py_ssize_t>(acting.steps), steps);
  if (acting.steps >= 0) steps = acting.steps;
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
  if (!prepare_results(of_rollout, out == Py_None ? nullptr : out, motions, {&q, &v, &acting.array}, results)) return nullptr;
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
  if (count > 0 && !find_batch(f)) return nullptr;
  Code& code = f.batch.entry && f.batch.entry->roll_out ? f.batch : f.single;
  {
    // Waking threads takes longer than some hundred states.
    const bool alone = static_cast<double>(count) * static_cast<double>(steps) < 256;
    const npy_intp most = alone ? 1 : std::min<npy_intp>((count + 15) / 16, Workers::instance().count());
    std::vector<Workspace> workspaces;
    for (npy_intp w = 0; w < std::max<npy_intp>(1, most); ++w) {
      workspaces.emplace_back(code);
      if (!workspaces.back().get()) return PyErr_NoMemory();
    }
    Contents of_states = f;  // as `f`, whose own may change while others hold the GIL
    Py_BEGIN_ALLOW_THREADS;
    run_motions(of_states, code, call, joints, workspaces);
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
