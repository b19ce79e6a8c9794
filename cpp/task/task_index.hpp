// Look-ups in a task: facts and operators by name, the operators that a state allows. Each is built at first use.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "task/packed_state.hpp"
#include "task/task.hpp"

namespace explicable {

class TaskIndex {
public:
    explicit TaskIndex(const Task& task) : task_(task) {}

    FactId find_fact(std::int32_t predicate, std::span<const std::int32_t> arguments) {
        const auto found = find(facts_, task_.fact_predicate, task_.fact_arguments, predicate, arguments);
        return found.empty() ? -1 : found[0];
    }
    // Several if the action's precondition was a disjunction.
    std::span<const OperatorId> find_operators(std::int32_t schema, std::span<const std::int32_t> arguments) {
        return find(operators_, task_.operator_schema, task_.operator_arguments, schema, arguments);
    }

    bool is_applicable(const StatePacker& packer, const Word* state, OperatorId op) const {
        const auto precondition = task_.preconditions[op];
        return std::all_of(precondition.begin(), precondition.end(),
                           [&](FactId fact) { return packer.holds(state, fact); });
    }
    // Sorted.
    std::vector<OperatorId> applicable(const StatePacker& packer, const Word* state) {
        if (operators_by_fact_.size() == 0) file_operators();
        std::vector<OperatorId> result;
        auto try_all = [&](std::span<const OperatorId> candidates) {
            for (const OperatorId op : candidates)
                if (is_applicable(packer, state, op)) result.push_back(op);
        };
        try_all(operators_by_fact_[task_.num_facts()]);
        for (VariableId variable = 0; variable < task_.num_variables(); ++variable)
            if (const std::int32_t value = packer.get(state, variable))
                try_all(operators_by_fact_[task_.variable_facts[variable][value - 1]]);
        std::sort(result.begin(), result.end());
        return result;
    }

private:
    // The numbers of all rows, in the order of (key, row), and the range of those that equal the ones sought.
    static std::span<const std::int32_t> find(std::vector<std::int32_t>& order, const std::vector<std::int32_t>& keys,
                                              const Table<std::int32_t>& rows, std::int32_t key,
                                              std::span<const std::int32_t> row) {
        auto before = [&](std::int32_t key_a, auto a, std::int32_t key_b, auto b) {
            return key_a != key_b ? key_a < key_b : std::ranges::lexicographical_compare(a, b);
        };
        if (order.size() != keys.size()) {
            order.resize(keys.size());
            std::iota(order.begin(), order.end(), 0);
            std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
                return before(keys[a], rows[a], keys[b], rows[b]);
            });
        }
        const auto first = std::partition_point(
            order.begin(), order.end(), [&](std::int32_t i) { return before(keys[i], rows[i], key, row); });
        const auto last = std::partition_point(
            first, order.end(), [&](std::int32_t i) { return !before(key, row, keys[i], rows[i]); });
        return {first, last};
    }

    // Each operator under the fact of its precondition that the fewest operators ask for; the last row holds
    // those that ask for none.
    void file_operators() {
        std::vector<std::int32_t> demand(task_.num_facts() + 1, 0);
        for (const FactId fact : task_.preconditions.values) ++demand[fact];
        std::vector<FactId> place(task_.num_operators(), task_.num_facts());
        std::vector<std::int32_t> start(task_.num_facts() + 2, 0);
        for (OperatorId op = 0; op < task_.num_operators(); ++op) {
            const auto facts = task_.preconditions[op];
            if (!facts.empty())
                place[op] = *std::min_element(facts.begin(), facts.end(),
                                              [&](FactId a, FactId b) { return demand[a] < demand[b]; });
            ++start[place[op] + 1];
        }
        std::partial_sum(start.begin(), start.end(), start.begin());
        operators_by_fact_.offsets = start;
        operators_by_fact_.values.resize(task_.num_operators());
        for (OperatorId op = 0; op < task_.num_operators(); ++op) operators_by_fact_.values[start[place[op]]++] = op;
    }

    const Task& task_;
    std::vector<FactId> facts_;
    std::vector<OperatorId> operators_;
    Table<OperatorId> operators_by_fact_;
};

}  // namespace explicable
