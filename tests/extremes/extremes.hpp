// One robot of the catalogue, measured.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "catalogue.hpp"
#include "pipeline.hpp"

namespace dalembert::extremes {

inline constexpr const char* quantities[] = {"mass_matrix", "coriolis_matrix", "gravity", "bias"};

// Worst over the states, generated double against 50 digits.
struct Figures {
  std::array<double, 4> ulp{};         // of the largest exact element, by `quantities`
  std::array<double, 4> normalised{};  // the same with row and column i divided by √M_ii
  double condition = 0;                // largest of M so divided: M's, but for the joints' units
  double forward = 0;                  // error of forward dynamics over 10 cond(M) 2⁻⁵³
  double forward_normalised = 0;       // the same, accelerations times √M_ii, over the condition above
  bool reported = false;               // forward dynamics says that M is singular in some state
  bool finite = true;
};

// All that is measured of it being asked for.
Model model_of(const Robot& robot);

// Compiles with these flags; `states` moderate random states. Takes a second and more.
Figures measure(const Robot& robot, int states, const std::string& flags);

}  // namespace dalembert::extremes
