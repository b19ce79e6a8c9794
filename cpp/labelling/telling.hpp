// Telling as a step of the plan: what the person has been told is one more variable of the task, and the labeller looks at
// each step with the mental model that the person has by then (docs/method.md, section 4).
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "labelling/scorer.hpp"
#include "search/path_scorer.hpp"
#include "task/task.hpp"

namespace explicable {

// Leads from one set of things told to another that has one thing more; `schema` numbers that thing.
struct Telling {
    std::int32_t from, to, schema;
};

// The task with one more variable, whose values are the sets that can have been told, 0 at the start; and an operator of cost 0 for
// each telling. Throws std::invalid_argument if a telling leads to no set.
Task with_telling(const Task& task, std::int32_t num_sets, const std::vector<Telling>& tellings);

// Scores paths of such a task: one scorer for each set, all of one labeller and of the task without telling.
class TellingScorer : public PathScorer {
public:
    // `price` of each telling, in the unit of cost.
    TellingScorer(const Task& task, std::vector<Scorer> scorers, double price)
        : scorers_(std::move(scorers)),
          told_(task.num_variables()),
          first_telling_(task.num_operators()),
          price_(price) {}

    bool fits(const Task& task) const override {
        return task.num_variables() == told_ + 1 && task.num_operators() >= first_telling_ &&
               task.variable_facts[told_].size() == scorers_.size();
    }
    std::size_t context_size() const override { return any().context_size(); }
    void root(const State& state, std::byte* context) const override { any().root(state, context); }
    void extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                std::byte* context) const override;
    PathScore score(const std::byte* context, const State& state, std::span<const OperatorId> plan) const override {
        return knowing(state).score(context, state, plan);
    }
    std::unique_ptr<Counter> counter() const override;
    // Two contexts are compared in one state, so the same has been told; and the rest is the same for all.
    std::uint64_t closing_key(const std::byte* context) const override { return any().closing_key(context); }
    double lead(const std::byte* a, const std::byte* b, const State& state) const override { return any().lead(a, b, state); }
    double charge(const std::byte* context) const override { return any().charge(context); }
    bool charges() const override { return true; }
    bool has_bounds() const override { return true; }
    double least_count(const std::byte* context) const override { return any().least_count(context); }
    double least_growth(const std::byte* parent, OperatorId step, const std::byte* child) const override {
        return step < first_telling_ ? any().least_growth(parent, step, child) : 0.0;
    }
    double least_end(const std::byte* context) const override { return any().least_end(context); }
    std::uint64_t outlook_key(const std::byte* context) const override { return any().outlook_key(context); }
    void widen(std::byte* context, const std::byte* other) const override { any().widen(context, other); }

private:
    std::vector<Scorer> scorers_;
    VariableId told_;
    OperatorId first_telling_;
    double price_;

    const Scorer& any() const { return scorers_.front(); }
    std::size_t set_told(const State& state) const {
        return static_cast<std::size_t>(std::max(state.values[told_], 1)) - 1;  // 0: nothing told either
    }
    const Scorer& knowing(const State& state) const { return scorers_[set_told(state)]; }
};

}  // namespace explicable
