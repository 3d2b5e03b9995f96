// What a farm computes: items by number, each of which is the same bits whoever computes it, whenever, beside whatever others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace farm {

// A result of each item: a row of `width` numbers, float64 or int32.
struct Column {
  std::string name, unit, meaning;
  std::size_t width = 1;
  bool integer = false;
  std::size_t bytes() const { return width * (integer ? sizeof(std::int32_t) : sizeof(double)); }
};

class Job {
 public:
  virtual ~Job() = default;
  virtual std::uint64_t items() const = 0;
  // Items that are computed in some 100 µs to 10 ms; between pieces rank 0 serves the others.
  virtual std::size_t piece() const = 0;
  // All that decides what the results are, a line for each: of two runs with the same text a result is the same.
  virtual std::string settings() const = 0;
  virtual std::vector<Column> columns() const = 0;
  // Items first, first + 1, … first + count - 1: into[c] is room for `count` rows of column c.
  virtual void compute(std::uint64_t first, std::size_t count, const std::vector<void*>& into) = 0;
};

// Forward dynamics of the arm at states drawn by their numbers: q, v, tau → v̇. results_only: what was drawn is not kept.
std::unique_ptr<Job> make_sweep(std::uint64_t states, std::uint64_t seed, bool results_only);

// A motion of the arm as it was recorded: `steps` of time_step seconds.
struct Recording {
  double time_step = 0;  // s
  std::size_t steps = 0;
  std::vector<double> q, v, tau;  // (steps + 1) × nq, (steps + 1) × nv, steps × nv: rad, rad/s, N m
};
// What the hand carries, drawn by number: a mass and where it is. Each candidate is a motion from where the recording begins,
// under its torques; its cost says how far it is from the recording.
std::unique_ptr<Job> make_identification(std::uint64_t candidates, std::uint64_t seed, Recording recording);

// A recording to try with: the hand carries 1.2 kg.
Recording simulate_recording(std::size_t steps, double time_step);

// Recordings as HDF5 files: datasets q, v and tau, and an attribute time_step. Throws Error, of wrong shapes too.
Recording read_recording(const std::string& file);
void write_recording(const std::string& file, const Recording& recording);

}  // namespace farm
