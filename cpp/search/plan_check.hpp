// Executes a plan on sets of facts: slow, plain, and independent of what the searches use.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "task/state.hpp"

namespace explicable {

// The plan's cost; nothing if a step is not applicable or the goal does not hold at the end.
std::optional<std::int64_t> execute_plan(const Task& task, const State& initial, std::span<const FactId> goal,
                                         std::span<const OperatorId> plan);

}  // namespace explicable
