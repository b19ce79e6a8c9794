#include "search/possible.hpp"

#include <algorithm>
#include <utility>

namespace explicable {

Possible find_possible(const PreparedTask& prepared, const State& state) {
    const Task& task = prepared.task();
    Possible answer{std::vector<char>(task.num_operators(), 0), std::vector<char>(task.num_facts(), 0)};
    auto& [possible, reached] = answer;
    std::vector<FactId> stack;
    const auto reach = [&](FactId fact) {
        if (reached[fact]) return;
        reached[fact] = 1;
        stack.push_back(fact);
    };
    for (VariableId variable = 0; variable < task.num_variables(); ++variable) {
        if (const auto value = state.values[variable]) reach(task.variable_facts[variable][value - 1]);
    }
    // Conditions of effects are left out: that only makes more possible.
    const auto& needing = prepared.needing();
    std::vector<std::int32_t> missing(task.num_operators());
    const auto execute = [&](OperatorId id) {
        possible[id] = 1;
        for (const FactId fact : task.adds[id]) reach(fact);
        for (auto effect = task.effect_offsets[id]; effect < task.effect_offsets[id + 1]; ++effect) {
            for (const FactId fact : task.effect_adds[effect]) reach(fact);
        }
    };
    for (OperatorId id = 0; id < task.num_operators(); ++id) {
        missing[id] = static_cast<std::int32_t>(task.preconditions[id].size());
        if (missing[id] == 0) execute(id);
    }
    while (!stack.empty()) {
        const FactId fact = stack.back();
        stack.pop_back();
        for (const OperatorId id : needing[fact]) {
            if (--missing[id] == 0) execute(id);
        }
    }
    return answer;
}

KnownPossible::Entry KnownPossible::find(const State& state) {
    auto known = std::find_if(known_.begin(), known_.end(), [&](const Known& other) { return is_alike(other, state); });
    if (known == known_.end()) {
        auto possible = find_possible(prepared_, state);
        known = std::find_if(known_.begin(), known_.end(), [&](const Known& other) {
            return other.entry.possible->operators == possible.operators && other.entry.possible->facts == possible.facts;
        });
        if (known == known_.end()) {
            bytes_ += possible.memory_bytes();
            known_.push_front({state, {next_number_++, std::make_shared<const Possible>(std::move(possible))}});
            while (bytes_ > most_bytes && known_.size() > 1) {
                bytes_ -= known_.back().entry.possible->memory_bytes();
                known_.pop_back();
            }
            return known_.front().entry;
        }
    }
    known->state = state;  // the next question is mostly about a state near by
    known_.splice(known_.begin(), known_, known);
    return known_.front().entry;
}

// The same is possible from two states if each is possible from the other.
bool KnownPossible::is_alike(const Known& known, const State& state) const {
    const Task& task = prepared_.task();
    const Possible& possible = *known.entry.possible;
    std::vector<FactId> gained, lost;
    for (VariableId variable = 0; variable < task.num_variables(); ++variable) {
        const auto before = known.state.values[variable], after = state.values[variable];
        if (before == after) continue;
        if (after) gained.push_back(task.variable_facts[variable][after - 1]);
        if (before) lost.push_back(task.variable_facts[variable][before - 1]);
    }
    if (!std::all_of(gained.begin(), gained.end(), [&](FactId fact) { return possible.facts[fact] != 0; })) return false;
    // So no more is possible than was.
    const auto may_be_had_again = [&](FactId fact) {
        const auto& adding = prepared_.achievers()[fact];
        return std::any_of(adding.begin(), adding.end(), [&](OperatorId id) { return possible.operators[id] != 0; });
    };
    return std::all_of(lost.begin(), lost.end(), may_be_had_again) && regains(state, gained, lost);
}

// Breadth first from what is new in a state; false also where that takes too long.
bool KnownPossible::regains(const State& state, const std::vector<FactId>& gained, const std::vector<FactId>& lost) const {
    const Task& task = prepared_.task();
    std::vector<char> found(task.num_facts(), 0);
    std::vector<FactId> queue;
    std::size_t num_lost = lost.size();
    const auto reach = [&](FactId fact) {
        if (found[fact]) return;
        found[fact] = 1;
        queue.push_back(fact);
        if (std::find(lost.begin(), lost.end(), fact) != lost.end()) --num_lost;
    };
    for (const FactId fact : gained) reach(fact);
    std::int64_t looked_at = 0;
    for (std::size_t next = 0; num_lost > 0 && next < queue.size(); ++next) {
        for (const OperatorId id : prepared_.needing()[queue[next]]) {
            if (++looked_at > most_looked_at) return false;
            const auto needed = task.preconditions[id];
            if (!std::all_of(needed.begin(), needed.end(), [&](FactId f) { return found[f] || state.holds(task, f); })) continue;
            for (const FactId fact : task.adds[id]) reach(fact);
            for (auto effect = task.effect_offsets[id]; effect < task.effect_offsets[id + 1]; ++effect) {
                for (const FactId fact : task.effect_adds[effect]) reach(fact);
            }
        }
    }
    return num_lost == 0;
}

}  // namespace explicable
