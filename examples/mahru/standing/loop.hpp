// The 1 kHz loop, as the controller's: plant and law share the thread and go in step, a rehearsal of the law with the last
// tick's state warms the caches before the tick. Nothing in here allocates, locks or prints.
#pragma once

#include <vector>

#include "law.hpp"
#include "plan.hpp"
#include "plant.hpp"
#include "record.hpp"

namespace standing {

// Until the plan ends or the robot lies. Returns how many ticks that took; ticks: as many as the plan has.
std::size_t run_loop(Law& law, const VectorJ& limits, Plant& plant, const Plan& plan, Plant::Account& account,
                     std::vector<Tick>& ticks) noexcept;

}  // namespace standing
