#include "call.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "function.hpp"
#include "workers.hpp"

namespace dalembert::python {

PyObject* packed(const Contents& f, std::vector<Owned>& results, bool as_scalar) {
  const auto item = [&](Owned& owned) {
    PyObject* const object = owned.release();
    return as_scalar && PyArray_NDIM(reinterpret_cast<PyArrayObject*>(object)) == 0
               ? PyArray_Return(reinterpret_cast<PyArrayObject*>(object))
               : object;
  };
  if (!f.result_type) return item(results[0]);
  auto* const type = reinterpret_cast<PyTypeObject*>(f.result_type);
  Owned tuple(type->tp_alloc(type, static_cast<Py_ssize_t>(results.size())));
  if (!tuple) return nullptr;
  for (std::size_t i = 0; i < results.size(); ++i) {
    PyObject* const object = item(results[i]);
    if (!object) return nullptr;
    PyTuple_SET_ITEM(tuple.get(), static_cast<Py_ssize_t>(i), object);
  }
  return tuple.release();
}

bool find_batch(Contents& f) {
  if (f.batch.entry || !f.find_batch) return true;
  const Owned found(PyObject_CallNoArgs(f.find_batch));
  if (!found) return false;
  if (f.batch.entry || !f.find_batch) return true;  // another thread's doing, meanwhile
  if (found.get() == Py_None) {
    Py_CLEAR(f.find_batch);
    return true;
  }
  PyObject* library;
  int entry;
  if (!PyArg_ParseTuple(found.get(), "Oi", &library, &entry)) return false;
  const FunctionTable* const table = table_of(library);
  if (!table) return false;
  if (entry < 0 || entry >= table->functions || table->entries[entry].results != f.single.entry->results ||
      table->scalar_bytes != static_cast<std::int32_t>(f.scalar)) {
    PyErr_SetString(PyExc_OSError, "the compiled batches are not of this robot");
    return false;
  }
  f.batch.library = Py_NewRef(library);
  f.batch.entry = &table->entries[entry];
  return true;
}

namespace {

// What the coordinate is called: "joint 'knee' (v[7])".
PyObject* complain_singular(const Contents& f, std::int32_t status) {
  if (status >= f.nv)
    return PyErr_Format(
        singular_error,
        "%U: linkage %zd (from 0) is at a toggle point: its loops do not tell where the joints that follow go, and "
        "nothing can be told of this state",
        f.name, static_cast<Py_ssize_t>(status - f.nv));
  PyObject* const name = status < PyTuple_GET_SIZE(f.coordinates) ? PyTuple_GET_ITEM(f.coordinates, status) : f.name;
  return PyErr_Format(singular_error,
                      "%U: the mass matrix is not positive definite at this state, as the pivot of %U shows: look for bodies "
                      "without mass and for states that are no poses",
                      f.name, name);
}

double number(const Contents& f, const void* data, std::ptrdiff_t i) {
  return f.type == NPY_DOUBLE ? static_cast<const double*>(data)[i] : static_cast<const float*>(data)[i];
}

// The first number of some that is not finite; their count, where all are.
npy_intp not_finite(const Contents& f, const void* data, std::ptrdiff_t first, npy_intp size) {
  npy_intp i = 0;
  while (i < size && std::isfinite(number(f, data, first + i))) ++i;
  return i;
}

// Of one state that was refused: where a number is not finite.
bool all_finite(const Contents& f, const char* what, const void* data, npy_intp size) {
  const npy_intp i = not_finite(f, data, 0, size);
  if (i == size) return true;
  PyErr_Format(PyExc_ValueError, "%U: %s[%zd] is %s, and the function needs finite numbers", f.name, what,
               static_cast<Py_ssize_t>(i), std::isnan(number(f, data, i)) ? "nan" : "infinite");
  return false;
}

// ---- The long way

// Runs the call's states, on several threads where that pays. Without the GIL.
void run_states(const FunctionEntry& entry, FunctionCall call, const std::vector<Workspace>& workspaces, double& nanoseconds) {
  using Clock = std::chrono::steady_clock;
  const std::ptrdiff_t end = call.end;
  if (nanoseconds == 0) {  // the second of two: the first fetches code and tables
    for (std::ptrdiff_t part = 0; part < 2 && call.begin < end; ++part) {
      call.end = std::min(end, call.begin + 8);
      const auto start = Clock::now();
      entry.run(call, workspaces[0].get());
      const double taken = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      nanoseconds = std::max(1.0, taken / static_cast<double>(call.end - call.begin));
      call.begin = call.end;
    }
    call.end = end;
  }
  const std::ptrdiff_t left = end - call.begin;
  const int threads = static_cast<int>(workspaces.size());
  constexpr double worth_waking = 40e3;  // ns
  if (threads == 1 || static_cast<double>(left) * nanoseconds < worth_waking) {
    if (left > 0) entry.run(call, workspaces[0].get());
    return;
  }
  const std::ptrdiff_t chunk = std::max<std::ptrdiff_t>(1, left / (8 * threads));
  std::atomic<std::ptrdiff_t> next{call.begin};
  Workers::instance().run(threads, [&](int w) {
    FunctionCall part = call;
    for (;;) {
      part.begin = next.fetch_add(chunk);
      if (part.begin >= end) return;
      part.end = std::min(end, part.begin + chunk);
      entry.run(part, workspaces[static_cast<std::size_t>(w)].get());
    }
  });
}

// Says at how many of the states M is singular, or else loops do not tell where joints are. Whether to go on: a warning may be
// an error.
bool warn_of_states(const Contents& f, const FunctionCall& call, const Argument& q, bool toggle) {
  const auto is_one = [&](std::int32_t status) { return status >= 0 && (status >= f.nv) == toggle; };
  const std::ptrdiff_t at = std::find_if(call.status, call.status + call.end, is_one) - call.status;
  if (at == call.end) return true;
  const bool finite = not_finite(f, q.rows.first, at * q.rows.step, f.nq) == f.nq;
  return PyErr_WarnFormat(singular_warning, 1,
                          "%U: %s at %zd of %zd states, the first of them number %zd%s: %s zero there; "
                          "return_status=True tells which",
                          f.name, toggle ? "loops are at toggle points" : "the mass matrix is not positive definite",
                          static_cast<Py_ssize_t>(std::count_if(call.status, call.status + call.end, is_one)),
                          static_cast<Py_ssize_t>(call.end), static_cast<Py_ssize_t>(at),
                          finite ? "" : ", whose q is not finite",
                          toggle ? "all results are" : "what needs its inverse is") == 0;
}

// dalembert.ConstraintStatus of numbers three by three. states: -1 for one without an axis.
PyObject* constraint_status(const double* numbers, npy_intp states) {
  Owned result(PyStructSequence_New(constraint_status_type));
  for (int i = 0; result && i < 3; ++i) {
    PyObject* field;
    if (states < 0) {
      field = i < 2 ? PyFloat_FromDouble(numbers[i]) : PyLong_FromDouble(numbers[i]);
      if (!field) return nullptr;
    } else {
      field = PyArray_SimpleNew(1, &states, i < 2 ? NPY_DOUBLE : NPY_INT32);
      if (!field) return nullptr;
      void* const data = PyArray_DATA(reinterpret_cast<PyArrayObject*>(field));
      for (npy_intp s = 0; s < states; ++s) {
        if (i < 2) static_cast<double*>(data)[s] = numbers[3 * s + i];
        else static_cast<std::int32_t*>(data)[s] = static_cast<std::int32_t>(numbers[3 * s + i]);
      }
    }
    PyStructSequence_SET_ITEM(result.get(), i, field);
  }
  return result.release();
}

PyObject* long_way(Contents& f, PyObject* const* args, Py_ssize_t given_count, PyObject* keywords) {
  Given given;
  if (!sort_arguments(f, args, given_count, keywords, given)) return nullptr;
  Argument q, v, more;
  if (!take(f, given.q, name_q, f.nq, q)) return nullptr;
  if (given.v && !take(f, given.v, name_v, f.nv, v)) return nullptr;
  if (given.more && !take(f, given.more, f.more, f.nv, more)) return nullptr;
  if (!given.v) v.rows.first = f.zeros.data();
  npy_intp states = -1;
  PyObject* first = nullptr;
  for (const auto& [argument, name] : {std::pair{&q, name_q}, {&v, name_v}, {&more, f.more}}) {
    if (argument->states < 0) continue;
    if (states >= 0 && argument->states != states) {
      PyErr_Format(PyExc_ValueError, "%U: %U has %zd states and %U has %zd", f.name, first, static_cast<Py_ssize_t>(states),
                   name, static_cast<Py_ssize_t>(argument->states));
      return nullptr;
    }
    states = argument->states;
    if (!first) first = name;
  }
  FunctionCall call{};
  std::vector<Argument> own;
  std::vector<unsigned char> memory;
  if (!take_run_time(f, given, own, states, memory, call.run_time)) return nullptr;
  call.q = q.rows;
  call.v = v.rows;
  call.more = more.rows;
  Results results;
  if (!prepare_results(f, given.out, states, {&q, &v, &more}, results)) return nullptr;
  if (!are_quaternions(f, call.q, states)) return nullptr;
  std::vector<void*> data;
  for (std::size_t i = 0; i < results.arrays.size(); ++i)
    data.push_back(PyArray_DATA((results.written_to[i] ? results.written_to[i] : results.arrays[i]).array()));
  call.results = data.data();
  const bool many = states >= 0;
  call.end = many ? states : 1;
  Owned status;
  if (f.single.entry->has_status || given.return_status) {
    npy_intp size = call.end;
    status = Owned(PyArray_SimpleNew(1, &size, NPY_INT32));
    if (!status) return nullptr;
    auto* const numbers = static_cast<std::int32_t*>(PyArray_DATA(status.array()));
    std::fill_n(numbers, size, -1);
    if (f.single.entry->has_status) call.status = numbers;
  }
  Owned constraints;
  if (given.return_constraint_status) {
    npy_intp size[] = {call.end, 3};
    constraints = Owned(PyArray_SimpleNew(2, size, NPY_DOUBLE));
    if (!constraints) return nullptr;
    call.constraints = static_cast<double*>(PyArray_DATA(constraints.array()));
  }
  // Batches of states in lanes have no such status.
  const bool by_batch = many && !given.return_constraint_status;
  if (by_batch && states > 0 && !find_batch(f)) return nullptr;
  Code& code = by_batch && f.batch.entry ? f.batch : f.single;
  {
    std::vector<Workspace> workspaces;
    const int threads =
        many ? static_cast<int>(std::min<npy_intp>(std::max<npy_intp>(1, states), Workers::instance().count())) : 1;
    for (int w = 0; w < threads; ++w) {
      workspaces.emplace_back(code);
      if (!workspaces.back().get()) return PyErr_NoMemory();
    }
    double nanoseconds = many ? code.nanoseconds : 1;
    Py_BEGIN_ALLOW_THREADS;
    run_states(*code.entry, call, workspaces, nanoseconds);
    Py_END_ALLOW_THREADS;
    if (many) code.nanoseconds = nanoseconds;
  }
  if (call.status && !given.return_status) {
    const std::ptrdiff_t singular = std::count_if(call.status, call.status + call.end, [](std::int32_t s) { return s >= 0; });
    if (singular > 0 && !many) {
      if (all_finite(f, "q", q.rows.first, f.nq) && all_finite(f, "v", v.rows.first, f.nv))
        complain_singular(f, call.status[0]);
      return nullptr;
    }
    if (singular > 0 && !(warn_of_states(f, call, q, false) && warn_of_states(f, call, q, true))) return nullptr;
  }
  for (std::size_t i = 0; i < results.arrays.size(); ++i)
    if (results.written_to[i] && PyArray_CopyInto(results.arrays[i].array(), results.written_to[i].array()) < 0) return nullptr;
  Owned packed_results(packed(f, results.arrays, !given.out));
  if (!packed_results) return nullptr;
  if (!given.return_status && !given.return_constraint_status) return packed_results.release();
  if (given.return_status && !many) {
    const std::int32_t number = static_cast<std::int32_t*>(PyArray_DATA(status.array()))[0];
    status = Owned(PyLong_FromLong(number));
    if (!status) return nullptr;
  }
  Owned of_constraints(given.return_constraint_status ? constraint_status(call.constraints, many ? call.end : -1) : nullptr);
  if (given.return_constraint_status && !of_constraints) return nullptr;
  if (!given.return_constraint_status) return Py_BuildValue("(NN)", packed_results.release(), status.release());
  if (!given.return_status) return Py_BuildValue("(NN)", packed_results.release(), of_constraints.release());
  return Py_BuildValue("(NNN)", packed_results.release(), status.release(), of_constraints.release());
}

// ---- The short way

// The numbers of one state, where the argument needs nothing done to it.
inline const void* plain(const Contents& f, PyObject* object, npy_intp size) {
  if (Py_TYPE(object) != &PyArray_Type) return nullptr;
  auto* const array = reinterpret_cast<PyArrayObject*>(object);
  if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != size || PyArray_TYPE(array) != f.type || !PyArray_ISCARRAY_RO(array))
    return nullptr;
  return PyArray_DATA(array);
}

inline bool is_plain_result(const Contents& f, PyObject* object, const Shape& shape) {
  if (Py_TYPE(object) != &PyArray_Type) return false;
  auto* const array = reinterpret_cast<PyArrayObject*>(object);
  if (PyArray_NDIM(array) != shape.dimensions || PyArray_TYPE(array) != f.type || !PyArray_ISCARRAY(array)) return false;
  for (int i = 0; i < shape.dimensions; ++i)
    if (PyArray_DIM(array, i) != shape.size[i]) return false;
  return true;
}

}  // namespace

PyObject* call(PyObject* self, PyObject* const* args, std::size_t flagged, PyObject* keywords) {
  Contents& f = *reinterpret_cast<Function*>(self)->contents;
  const Py_ssize_t given = PyVectorcall_NARGS(flagged);
  const Py_ssize_t most = f.more ? 3 : 2, least = f.more ? 3 : f.needs_v ? 2 : 1;
  PyObject* out = nullptr;
  if (keywords) {
    if (PyTuple_GET_SIZE(keywords) != 1 || PyTuple_GET_ITEM(keywords, 0) != name_out || f.result_type)
      return long_way(f, args, given, keywords);
    out = args[given];
    if (!is_plain_result(f, out, f.shapes[0])) return long_way(f, args, given, keywords);
  }
  if (given < least || given > most) return long_way(f, args, given, keywords);
  FunctionCall call{};
  call.q.first = plain(f, args[0], f.nq);
  call.v.first = given > 1 ? plain(f, args[1], f.nv) : f.zeros.data();
  call.more.first = given > 2 ? plain(f, args[2], f.nv) : nullptr;
  if (!call.q.first || !call.v.first || (given > 2 && !call.more.first)) return long_way(f, args, given, keywords);
  if (!are_quaternions(f, call.q, -1)) return nullptr;
  const Workspace workspace(f.single);
  if (!workspace.get()) return PyErr_NoMemory();
  if (f.run_time) call.run_time.first = PyArray_DATA(reinterpret_cast<PyArrayObject*>(f.run_time));
  std::int32_t status = -1;
  call.status = f.single.entry->has_status ? &status : nullptr;
  call.end = 1;
  const auto refused = [&]() -> PyObject* {
    if (all_finite(f, "q", call.q.first, f.nq) && all_finite(f, "v", call.v.first, f.nv)) complain_singular(f, status);
    return nullptr;
  };
  if (!f.result_type) {
    PyObject* const result = out ? Py_NewRef(out) : new_result(f, f.shapes[0], -1);
    if (!result) return nullptr;
    void* const data = PyArray_DATA(reinterpret_cast<PyArrayObject*>(result));
    call.results = &data;
    f.single.entry->run(call, workspace.get());
    if (status >= 0) {
      Py_DECREF(result);
      return refused();
    }
    return out || f.shapes[0].dimensions > 0 ? result : PyArray_Return(reinterpret_cast<PyArrayObject*>(result));
  }
  std::vector<Owned> results;
  std::vector<void*> data;
  for (const Shape& shape : f.shapes) {
    results.emplace_back(new_result(f, shape, -1));
    if (!results.back()) return nullptr;
    data.push_back(PyArray_DATA(results.back().array()));
  }
  call.results = data.data();
  f.single.entry->run(call, workspace.get());
  return status >= 0 ? refused() : packed(f, results, true);
}

}  // namespace dalembert::python
