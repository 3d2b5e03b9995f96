// HDF5's handles, closed when they go. What the library says of errors is not printed: callers say what failed.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

#include "error.hpp"

namespace farm {

class Handle {
 public:
  Handle(hid_t id, herr_t (*closes)(hid_t), const std::string& failed) : id_(id), closes_(closes) {
    if (id < 0) throw Error(failed);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) closes_(id_);
  }
  operator hid_t() const { return id_; }
  // Whether closing it was no error; files write when they are closed.
  bool close() { return closes_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*closes_)(hid_t);
};

// To be called first. Nor does the library close at the program's end what could not be closed, which fails in ways of its own.
inline void no_hdf5_messages() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace farm
