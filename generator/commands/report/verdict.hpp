// What a report comes to, in a few sentences.
#pragma once

#include "commands/report/rows.hpp"

namespace dalembert::reporting {

// Adds a row per sentence, section `verdict`, made of the rows there are: the numbers in them are theirs, rounded. Returns
// whether no case of section `stability` went badly in double.
bool add_verdict(Rows& rows);

}  // namespace dalembert::reporting
