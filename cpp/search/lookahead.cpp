#include "search/lookahead.hpp"

#include <algorithm>

namespace explicable {

NodeId Lookahead::follow(std::span<const OperatorId> relaxed_plan, NodeStore& nodes, NodeId node, State& state) {
    const auto go = [&](OperatorId step) {
        node = nodes.add(node, step).node;
        nodes.state(node, state);
    };
    remaining_.assign(relaxed_plan.begin(), relaxed_plan.end());
    while (!remaining_.empty()) {
        std::size_t num_kept = 0;
        for (const OperatorId step : remaining_) {
            if (is_applicable(step, state)) {
                go(step);
            } else {
                remaining_[num_kept++] = step;
            }
        }
        const bool stuck = num_kept == remaining_.size();
        remaining_.resize(num_kept);
        if (!stuck) continue;
        const OperatorId replacement = repair(state);
        if (replacement < 0) break;
        go(replacement);
    }
    return node;
}

bool Lookahead::is_applicable(OperatorId step, const State& state) const {
    const auto needed = question_.task.preconditions[step];
    return std::all_of(needed.begin(), needed.end(),
                       [&](FactId fact) { return state.holds(question_.task, fact); });
}

// Takes an operator out of remaining_ and returns one to execute in its place, or -1.
OperatorId Lookahead::repair(const State& state) {
    mark_wanted(state);
    question_.successors.applicable(state, applicable_);
    const Task& task = question_.task;
    OperatorId best = -1;
    auto best_place = static_cast<std::int32_t>(remaining_.size());
    for (const OperatorId step : applicable_) {
        for (const FactId fact : task.adds[step]) {
            if (provided_[fact] != round_) continue;
            const std::int32_t place = provider_[fact];
            if (place > best_place || (place == best_place && task.cost[step] >= task.cost[best])) continue;
            best = step;
            best_place = place;
        }
    }
    if (best >= 0) remaining_.erase(remaining_.begin() + best_place);
    return best;
}

// Facts that the goal or an operator still to be executed needs, and which of the operators is the first to achieve each.
void Lookahead::mark_wanted(const State& state) {
    if (++round_ == 0) {  // the counter of rounds has wrapped: forget all marks
        std::fill(wanted_.begin(), wanted_.end(), 0);
        std::fill(provided_.begin(), provided_.end(), 0);
        round_ = 1;
    }
    const auto want = [&](std::span<const FactId> facts) {
        for (const FactId fact : facts) {
            if (!state.holds(question_.task, fact)) wanted_[fact] = round_;
        }
    };
    want(question_.goal);
    for (const OperatorId step : remaining_) want(question_.task.preconditions[step]);
    for (std::size_t place = 0; place < remaining_.size(); ++place) {
        for (const FactId fact : question_.task.adds[remaining_[place]]) {
            if (wanted_[fact] != round_ || provided_[fact] == round_) continue;
            provided_[fact] = round_;
            provider_[fact] = static_cast<std::int32_t>(place);
        }
    }
}

}  // namespace explicable
