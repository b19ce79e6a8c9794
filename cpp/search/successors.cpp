#include "search/successors.hpp"

#include <algorithm>
#include <utility>

namespace explicable {

namespace {

constexpr std::int32_t max_gap = 8;  // values apart by more do not share a branch, so that tables stay small

using Condition = std::pair<VariableId, std::int32_t>;

}  // namespace

struct SuccessorGenerator::Candidate {
    std::vector<Condition> conditions;  // sorted
    OperatorId id;
};

SuccessorGenerator::SuccessorGenerator(const Task& task) {
    std::vector<Candidate> candidates;
    candidates.reserve(task.num_operators());
    for (OperatorId id = 0; id < task.num_operators(); ++id) {
        Candidate candidate{{}, id};
        for (const FactId fact : task.preconditions[id]) {
            candidate.conditions.emplace_back(task.fact_variable[fact], task.fact_value[fact]);
        }
        auto& conditions = candidate.conditions;
        std::sort(conditions.begin(), conditions.end());
        conditions.erase(std::unique(conditions.begin(), conditions.end()), conditions.end());
        const bool contradictory =
            std::adjacent_find(conditions.begin(), conditions.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first; }) != conditions.end();
        if (!contradictory) candidates.push_back(std::move(candidate));
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.conditions != b.conditions ? a.conditions < b.conditions : a.id < b.id;
    });
    code_.push_back(0);  // so that 0 can mean "no child"
    root_ = build(candidates, 0, candidates.size(), 0);
}

// Candidates from begin to end agree in their first `depth` conditions; those with no more conditions come first.
std::int32_t SuccessorGenerator::build(std::vector<Candidate>& candidates, std::size_t begin, std::size_t end,
                                       std::size_t depth) {
    std::size_t rest = begin;
    while (rest < end && candidates[rest].conditions.size() == depth) ++rest;

    struct Child {
        Condition condition;
        std::int32_t node;
    };
    std::vector<Child> children;
    for (std::size_t first = rest; first < end;) {
        const Condition condition = candidates[first].conditions[depth];
        std::size_t last = first;
        while (last < end && candidates[last].conditions[depth] == condition) ++last;
        children.push_back({condition, build(candidates, first, last, depth + 1)});
        first = last;
    }

    std::vector<std::int32_t> branches;
    for (std::size_t first = 0; first < children.size();) {
        const auto [variable, low] = children[first].condition;
        std::size_t last = first + 1;
        while (last < children.size() && children[last].condition.first == variable &&
               children[last].condition.second - children[last - 1].condition.second <= max_gap) {
            ++last;
        }
        const std::int32_t num_values = children[last - 1].condition.second - low + 1;
        const auto table = static_cast<std::int32_t>(code_.size());
        code_.resize(code_.size() + num_values, 0);
        for (; first < last; ++first) code_[table + children[first].condition.second - low] = children[first].node;
        branches.insert(branches.end(), {variable, low, num_values, table});
    }

    const auto node = static_cast<std::int32_t>(code_.size());
    code_.push_back(static_cast<std::int32_t>(rest - begin));
    for (std::size_t i = begin; i < rest; ++i) code_.push_back(candidates[i].id);
    code_.push_back(static_cast<std::int32_t>(branches.size() / 4));
    code_.insert(code_.end(), branches.begin(), branches.end());
    return node;
}

void SuccessorGenerator::applicable(const State& state, std::vector<OperatorId>& operators) const {
    operators.clear();
    collect(root_, state, operators);
}

void SuccessorGenerator::collect(std::int32_t node, const State& state, std::vector<OperatorId>& operators) const {
    const std::int32_t* at = code_.data() + node;
    const std::int32_t num_operators = *at++;
    operators.insert(operators.end(), at, at + num_operators);
    at += num_operators;
    for (std::int32_t branches = *at++; branches > 0; --branches, at += 4) {
        const auto index = static_cast<std::uint32_t>(state.values[at[0]] - at[1]);
        if (index >= static_cast<std::uint32_t>(at[2])) continue;
        if (const std::int32_t child = code_[at[3] + index]) collect(child, state, operators);
    }
}

}  // namespace explicable
