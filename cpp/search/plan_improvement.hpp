// Makes a plan cheaper without searching for another: for plans that were found in haste. Nothing here looks at labels.
#pragma once

#include <cstdint>
#include <vector>

#include "search/engine.hpp"

namespace explicable {

// Drops each step, with those after it that can't be executed without it, where the goal is reached all the same (action
// elimination; Nakhost & Mueller 2010), until no step can be dropped or `max_executions` of steps are used up.
std::vector<OperatorId> eliminate_actions(const Question& question, std::vector<OperatorId> plan,
                                          std::int64_t max_executions);

// The cheapest plan among the states near those of `plan`: states are expanded breadth first from all of them at once, until
// there are `max_transitions` (plan neighbourhood graph search; Nakhost & Mueller 2010). It never costs more than `plan`.
std::vector<OperatorId> search_neighbourhood(const Question& question, std::vector<OperatorId> plan,
                                             std::size_t max_transitions);

}  // namespace explicable
