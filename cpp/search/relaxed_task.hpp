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

// Costs in the delete relaxation saturate below this, so that sums cannot overflow.
constexpr std::int32_t infinite_cost = 1'000'000'000;
constexpr std::int32_t max_operator_cost = 100'000'000;

// Pieces of operators, each with preconditions, a cost and facts that it adds. A conditional effect is a piece of its own, with
// the operator's preconditions and the effect's conditions.
struct RelaxedTask {
    // One piece an operator where there are no conditional effects.
    RelaxedTask(const Task& task, SupporterCost supporter_cost);

    // Makes one piece of all those that agree in preconditions and cost, and drops adds that another piece makes as cheaply
    // from fewer preconditions. h_add and h_max of facts stay what they are. In many domains a few per cent of the
    // pieces remain: all flights from one city, say, are one.
    void merge();

    Table<FactId> preconditions, adds;
    std::vector<OperatorId> owner;          // by place in adds.values
    std::vector<std::int32_t> piece_of;     // by place in adds.values
    std::vector<std::int32_t> cost;         // of pieces; at least 1
    Table<std::int32_t> precondition_of;    // fact -> pieces
    std::vector<std::int32_t> without_preconditions;

    std::int32_t size() const { return preconditions.size(); }

private:
    void add_piece(std::vector<FactId> needed, std::span<const FactId> added, OperatorId id, std::int32_t piece_cost);
    void index(std::int32_t num_facts);
};

// Row i of the result lists the rows of `table` in which i stands.
Table<std::int32_t> inverse(const Table<std::int32_t>& table, std::int32_t num_rows);

}  // namespace explicable
