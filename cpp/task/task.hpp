// The grounded task as flat arrays. Facts and operators are numbered from 0; everything else refers to them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace explicable {

using FactId = std::int32_t;
using OperatorId = std::int32_t;
using VariableId = std::int32_t;

// Rows of different lengths in one array: row i is values[offsets[i]] up to values[offsets[i + 1]].
template <class T>
struct Table {
    std::vector<std::int32_t> offsets{0};
    std::vector<T> values;

    std::int32_t size() const { return static_cast<std::int32_t>(offsets.size()) - 1; }
    std::span<const T> operator[](std::int32_t row) const {
        return {values.data() + offsets[row], values.data() + offsets[row + 1]};
    }
    template <class Range>
    void push_back(const Range& row) {
        values.insert(values.end(), std::begin(row), std::end(row));
        offsets.push_back(static_cast<std::int32_t>(values.size()));
    }
};

// A goal that is a disjunction becomes one fact, which auxiliary operators of cost 0 achieve, one a disjunct.
// They are not steps of a plan. The value stands for their schema and for the predicate of the fact.
constexpr std::int32_t auxiliary = std::numeric_limits<std::int32_t>::min();

struct Task {
    // Facts. Each belongs to one finite-domain variable; of a variable's facts at most one is true in any
    // reachable state. fact_value counts from 1; the value 0 means that none of the variable's facts is true.
    Table<FactId> variable_facts;
    std::vector<VariableId> fact_variable;
    std::vector<std::int32_t> fact_value;
    std::vector<std::int32_t> fact_predicate;  // index into the problem's predicates; ~index for a negated atom, `auxiliary`
    Table<std::int32_t> fact_arguments;        // object numbers

    // Operators; rows sorted by fact. A fact that is both deleted and added ends up true and stands in adds only.
    Table<FactId> preconditions, adds, deletes;
    std::vector<std::int32_t> cost;
    std::vector<std::int32_t> operator_schema;  // index into the problem's actions, or `auxiliary`
    Table<std::int32_t> operator_arguments;     // object numbers, one a parameter

    // Conditional effects: those of operator o are effect_offsets[o] up to effect_offsets[o + 1].
    std::vector<std::int32_t> effect_offsets{0};
    Table<FactId> effect_conditions, effect_adds, effect_deletes;

    std::vector<FactId> initial, goal;  // sorted
    bool goal_reachable = true;         // false: relaxed reachability already proves the goal out of reach

    std::int32_t num_facts() const { return static_cast<std::int32_t>(fact_variable.size()); }
    std::int32_t num_operators() const { return preconditions.size(); }
    std::int32_t num_variables() const { return variable_facts.size(); }
};

}  // namespace explicable
