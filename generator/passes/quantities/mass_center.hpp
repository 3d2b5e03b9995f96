// What quantities of the whole robot's centre of mass are made of.
#pragma once

#include "passes/builder.hpp"

namespace dalembert::passes {

// h of every subtree along the axes of its first body and about its origin; the base's: of the whole robot.
int first_moments(Builder& builder);

// One over the mass of all that moves, a role of the base. What is welded to a fixed base is no part of it.
int inverse_mass(Builder& builder);

// The axes of every body in the world, one after another.
int world_axes(Builder& builder);

// The world's velocity of the robot's centre of mass per unit of every coordinate.
int center_columns(Builder& builder);

}  // namespace dalembert::passes
