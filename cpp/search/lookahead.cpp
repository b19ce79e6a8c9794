#include "search/lookahead.hpp"

#include <algorithm>
#include <utility>

namespace explicable {

NodeId Lookahead::follow(std::span<const OperatorId> relaxed_plan, NodeStore& nodes, NodeId node, State& state,
                         Monitor& monitor) {
    const Task& task = question_.task;
    had_.resize(task.num_facts());
    for (FactId fact = 0; fact < task.num_facts(); ++fact) had_[fact] = state.holds(task, fact);
    remaining_.assign(relaxed_plan.begin(), relaxed_plan.end());
    bool may_bridge = bridged_;
    while (!remaining_.empty() && !monitor.is_time_up()) {
        if (execute_remaining(nodes, node, state)) {
            may_bridge = bridged_;
            continue;
        }
        question_.successors.applicable(state, applicable_);
        OperatorId next = replace(state);
        // Conditional effects may undo what a bridge was for, so a second one in a row could go on for ever.
        if (next < 0 && std::exchange(may_bridge, false)) next = bridge(state);
        if (next < 0) break;
        go(next, nodes, node, state);
    }
    return node;
}

void Lookahead::go(OperatorId step, NodeStore& nodes, NodeId& node, State& state) {
    node = nodes.add(node, step).node;
    nodes.state(node, state);
    for (const FactId fact : question_.task.adds[step]) had_[fact] = 1;
}

// One pass over remaining_; true if anything in it was applicable.
bool Lookahead::execute_remaining(NodeStore& nodes, NodeId& node, State& state) {
    std::size_t num_kept = 0;
    const std::size_t num_before = remaining_.size();
    for (const OperatorId step : remaining_) {
        if (is_applicable(step, state)) {
            go(step, nodes, node, state);
        } else {
            remaining_[num_kept++] = step;
        }
    }
    remaining_.resize(num_kept);
    return num_kept < num_before;
}

bool Lookahead::is_applicable(OperatorId step, const State& state) const {
    const auto needed = question_.task.preconditions[step];
    return std::all_of(needed.begin(), needed.end(),
                       [&](FactId fact) { return state.holds(question_.task, fact); });
}

// Takes an operator out of remaining_ and returns one to execute in its place, or -1.
OperatorId Lookahead::replace(const State& state) {
    mark_provided(state);
    const Task& task = question_.task;
    OperatorId best = -1;
    auto best_place = static_cast<std::int32_t>(remaining_.size());
    for (const OperatorId step : applicable_) {
        for (const FactId fact : task.adds[step]) {
            if (provided_[fact] != round_) continue;
            const std::int32_t place = place_[fact];
            if (place > best_place || (place == best_place && task.cost[step] >= task.cost[best])) continue;
            if (!serves(step, place)) continue;
            best = step;
            best_place = place;
        }
    }
    if (best >= 0) remaining_.erase(remaining_.begin() + best_place);
    return best;
}

// Facts that the goal or an operator still to be executed needs, and which of the operators is the first to achieve each.
void Lookahead::mark_provided(const State& state) {
    begin_round();
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
            place_[fact] = static_cast<std::int32_t>(place);
        }
    }
}

// Does `step` achieve all that the operator at `place` was to achieve first?
bool Lookahead::serves(OperatorId step, std::int32_t place) const {
    const auto asked = question_.task.adds[remaining_[place]], given = question_.task.adds[step];
    return std::all_of(asked.begin(), asked.end(), [&](FactId fact) {
        return provided_[fact] != round_ || place_[fact] != place || std::binary_search(given.begin(), given.end(), fact);
    });
}

// The cheapest operator that brings back the one fact which the first operator that can be helped so lacks, or -1: a vehicle
// that is to pick something up where it has been before goes back there.
OperatorId Lookahead::bridge(const State& state) {
    const Task& task = question_.task;
    begin_round();
    for (std::size_t place = 0; place < remaining_.size(); ++place) {
        const FactId fact = only_missing(remaining_[place], state);
        if (fact < 0 || !had_[fact] || wanted_[fact] == round_) continue;
        wanted_[fact] = round_;
        place_[fact] = static_cast<std::int32_t>(place);
    }
    OperatorId best = -1;
    auto best_place = static_cast<std::int32_t>(remaining_.size());
    for (const OperatorId step : applicable_) {
        for (const FactId fact : task.adds[step]) {
            if (wanted_[fact] != round_) continue;
            const std::int32_t place = place_[fact];
            if (place > best_place || (place == best_place && task.cost[step] >= task.cost[best])) continue;
            if (spoils(step, remaining_[place])) continue;
            best = step;
            best_place = place;
        }
    }
    return best;
}

// The only fact that keeps `step` from being applicable, or -1 where there are several.
FactId Lookahead::only_missing(OperatorId step, const State& state) const {
    FactId missing = -1;
    for (const FactId fact : question_.task.preconditions[step]) {
        if (state.holds(question_.task, fact)) continue;
        if (missing >= 0) return -1;
        missing = fact;
    }
    return missing;
}

// Does `step` delete what `other` needs?
bool Lookahead::spoils(OperatorId step, OperatorId other) const {
    const auto deletes = question_.task.deletes[step], needed = question_.task.preconditions[other];
    return std::any_of(needed.begin(), needed.end(),
                       [&](FactId fact) { return std::binary_search(deletes.begin(), deletes.end(), fact); });
}

void Lookahead::begin_round() {
    if (++round_ != 0) return;
    std::fill(wanted_.begin(), wanted_.end(), 0);  // the counter of rounds has wrapped: forget all marks
    std::fill(provided_.begin(), provided_.end(), 0);
    round_ = 1;
}

}  // namespace explicable
