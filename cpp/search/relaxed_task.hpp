// The delete relaxation of a task, as the heuristics use it.
#pragma once

#include <cstdint>
#include <vector>

#include "task/task.hpp"

namespace explicable {

enum class SupporterCost {
    unit,     // every operator costs 1: greedy search finds plans sooner so
    plus_one  // cost + 1: zero-cost operators still count as a step
};

// The operators of the delete relaxation. A conditional effect is a piece of its own, with the operator's preconditions
// and the effect's conditions; where there are none, piece p is operator p.
struct RelaxedTask {
    RelaxedTask(const Task& task, SupporterCost supporter_cost);

    Table<FactId> preconditions, adds;
    Table<std::int32_t> precondition_of;  // fact -> pieces
    std::vector<OperatorId> owner;
    std::vector<std::int32_t> cost;  // at least 1
    std::vector<std::int32_t> without_preconditions;

    std::int32_t size() const { return preconditions.size(); }
};

// Costs in the delete relaxation saturate below this, so that sums cannot overflow.
constexpr std::int32_t infinite_cost = 1'000'000'000;
constexpr std::int32_t max_operator_cost = 100'000'000;

// Row i of the result lists the rows of `table` in which i stands.
Table<std::int32_t> inverse(const Table<std::int32_t>& table, std::int32_t num_rows);

}  // namespace explicable
