#include <cmath>
#include <vector>

#include "farm_arm/dynamics.hpp"
#include "hdf5.hpp"
#include "job.hpp"

namespace farm {

namespace {

std::vector<double> read_array(hid_t file, const std::string& path, const char* name, std::size_t& rows, std::size_t columns) {
  const std::string what = path + ": dataset '" + name + "'";
  if (H5Lexists(file, name, H5P_DEFAULT) <= 0) throw Error(what + " is missing; a recording has q, v and tau");
  const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, what + " cannot be opened");
  const Handle space(H5Dget_space(set), H5Sclose, what + " has no shape");
  hsize_t size[2] = {0, 0};
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions == 2) H5Sget_simple_extent_dims(space, size, nullptr);
  if (dimensions != 2 || size[1] != columns || (rows > 0 && size[0] != rows) || size[0] == 0) {
    std::string is = "(";
    std::vector<hsize_t> all(dimensions > 0 ? static_cast<std::size_t>(dimensions) : 0);
    if (dimensions > 0) H5Sget_simple_extent_dims(space, all.data(), nullptr);
    for (std::size_t i = 0; i < all.size(); ++i) is += (i ? ", " : "") + std::to_string(all[i]);
    throw Error(what + " has shape " + is + "), expected (" + (rows > 0 ? std::to_string(rows) : "steps") + ", " +
                std::to_string(columns) + "): q and v have a row more than tau, a column for each joint of the arm");
  }
  rows = size[0];
  std::vector<double> numbers(size[0] * columns);
  if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0)
    throw Error(what + " cannot be read as numbers");
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i])) throw Error(what + ", row " + std::to_string(i / columns) + ": a number is not finite");
  return numbers;
}

void write_array(hid_t file, const std::string& path, const char* name, const std::vector<double>& numbers, std::size_t rows,
                 std::size_t columns) {
  const hsize_t size[] = {rows, columns};
  const std::string failed = path + ": dataset '" + name + "' cannot be written; is the disk full?";
  const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose, failed);
  const Handle set(H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, failed);
  if (H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0) throw Error(failed);
}

}  // namespace

Recording read_recording(const std::string& path) {
  no_hdf5_messages();
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                    path + ": no such HDF5 file; 'farm record --out FILE' makes one to try with");
  Recording r;
  const std::string failed = path + ": attribute 'time_step' is missing, or no number of seconds larger than zero";
  const Handle attribute(H5Aopen(file, "time_step", H5P_DEFAULT), H5Aclose, failed);
  const Handle space(H5Aget_space(attribute), H5Sclose, failed);
  if (H5Sget_simple_extent_npoints(space) != 1 || H5Aread(attribute, H5T_NATIVE_DOUBLE, &r.time_step) < 0 ||
      !(r.time_step > 0) || !std::isfinite(r.time_step))
    throw Error(failed);
  r.tau = read_array(file, path, "tau", r.steps, farm_arm::nv);
  std::size_t states = r.steps + 1;
  r.q = read_array(file, path, "q", states, farm_arm::nq);
  r.v = read_array(file, path, "v", states, farm_arm::nv);
  return r;
}

void write_recording(const std::string& path, const Recording& r) {
  no_hdf5_messages();
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
              path + ": cannot be made; is there one already, or no such folder?");
  const std::string failed = path + ": attribute 'time_step' cannot be written";
  {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, failed);
    const Handle attribute(H5Acreate2(file, "time_step", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failed);
    if (H5Awrite(attribute, H5T_NATIVE_DOUBLE, &r.time_step) < 0) throw Error(failed);
  }
  write_array(file, path, "q", r.q, r.steps + 1, farm_arm::nq);
  write_array(file, path, "v", r.v, r.steps + 1, farm_arm::nv);
  write_array(file, path, "tau", r.tau, r.steps, farm_arm::nv);
  if (!file.close()) throw Error(path + ": cannot be written whole; is the disk full?");
}

}  // namespace farm
